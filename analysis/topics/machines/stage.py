"""Solves each set-up on a machine by boundary elements, for every choice of what is neglected, and by the model; finished ones are not computed again."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from time import perf_counter
from typing import Any

from analysis.pipeline import model_stage
from analysis.pipeline.set_up_stages import SetUpStages
from analysis.results.answers import Estimate
from analysis.results.set_up import rectangles
from analysis.results.store import Document
from analysis.topics.errors import parts as parts_of_pairs
from analysis.topics.machines import parts
from analysis.topics.machines.set_ups import READING, SetUp
from geometries.scene.scene import Scene
from geometries.scene.writer import canonical

RTOL = 5e-2
"""Relative accuracy asked of a true change: the model is wrong by far more, and what is stated is mostly several times the true error."""
_RTOL_BETWEEN = 1e-1
"""That of the changes with something left out, which only the sizes of the parts depend on."""
_RTOL_OF_PLATES = 1e-3
"""That of one plate before another, whose error has smaller parts; it costs milliseconds."""
EVERY, FACING = "exact", "exact+facing"
METHODS = (EVERY, FACING, "formula")
"""The methods whose change is compared with the true one."""
_SECONDS = 2.0
_SOURCES = tuple(
    f"analysis/topics/{name}.py"
    for name in ("errors/paths", "errors/parts", "machines/parts", "machines/stage")
)


def answer(set_up: SetUp, _: Path) -> Document:
    """Computes the changes (F) of the reading: the true ones with their errors, and each method's; and sensor and target by themselves.

    `seconds` is the time of the full scene's solution, `seconds_of_all` that of all true changes.
    """
    model, seconds = model_stage.model_module(), []
    everything = parts.included(set_up)

    def change(chosen: tuple[str, ...]) -> Estimate:
        rtol = RTOL if chosen == everything else _RTOL_BETWEEN
        before = perf_counter()
        found = parts.added(_change(model, scene, rtol) for scene in parts.scenes(set_up, chosen))
        seconds.append(perf_counter() - before)
        return found

    pairs = _pairs(model, set_up)
    changes = {(): pairs.delta_self} | {chosen: change(chosen) for chosen in parts.choices(set_up) if chosen}
    return {
        # The choice of everything is the last.
        "seconds": seconds[-1],
        "seconds_of_all": sum(seconds),
        "changes": [{"included": chosen, **asdict(value)} for chosen, value in changes.items()],
        "pairs": asdict(pairs),
        "methods": {method: _by(model, set_up, method) for method in METHODS},
    }


def _change(model: Any, scene: Scene, rtol: float) -> Estimate:
    reading = model.Scene.loads(canonical(scene)).readings("boundary-elements", rtol=rtol)[READING]
    return Estimate(float(reading.change), float(reading.error["change"]))


def _by(model: Any, set_up: SetUp, method: str) -> Document:
    """Computes a method's change for the grounded target: no method of the model knows another one."""
    scene = parts.scenes(set_up, tuple(name for name in parts.COMPANY if name != parts.GROUNDING))[0]
    loaded = model.Scene.loads(canonical(scene))
    before = perf_counter()
    try:
        reading = loaded.readings(**model_stage.options(method))[READING]
    except ValueError as error:
        return {"refused": str(error)}
    return {"change": float(reading.change), "seconds": perf_counter() - before}


def _pairs(model: Any, set_up: SetUp) -> parts.Pairs:
    """Solves the sensor with each body of the target by itself, and takes the model's error apart if that is one plate."""
    scenes = parts.scenes(set_up, ())
    plates = rectangles(scenes[0]) if len(scenes) == 1 else None
    by_model = {method: sum(_model(model, scene, method) for scene in scenes) for method in (EVERY, FACING)}
    return parts.Pairs(
        truths=tuple(_truth(model, scene, _RTOL_OF_PLATES if plates else RTOL) for scene in scenes),
        every=by_model[EVERY],
        facing=by_model[FACING],
        split=parts_of_pairs.split(model, *plates) if plates else None,
    )


def _truth(model: Any, scene: Scene, rtol: float) -> parts_of_pairs.Truth:
    solved = model.Scene.loads(canonical(scene)).maxwell(rtol=rtol)
    alone = solved["delta_self"][scene.sensors[0].name]
    matrix, errors = solved["maxwell"], solved["error"]
    return parts_of_pairs.Truth(
        mutual=Estimate(-float(matrix[0][1]), float(errors[0][1])),
        delta_self=Estimate(float(alone["value"]), float(alone["error"])),
        target_own=Estimate(float(matrix[1][1]), float(errors[1][1])),
    )


def _model(model: Any, scene: Scene, method: str) -> float:
    return float(model.Scene.loads(canonical(scene)).readings(**model_stage.options(method))[READING].change)


STAGES = SetUpStages[SetUp](
    name="machines",
    what="set-ups on machines",
    rtol=RTOL,
    sources=(*_SOURCES, "analysis/results/set_up.py"),
    seconds=lambda _: _SECONDS,
    answer=answer,
)
