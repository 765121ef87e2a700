"""Compares the model with the stored truths of each set-up on a machine; finished ones are not computed again."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from time import perf_counter
from typing import Any

from analysis.pipeline import model_stage
from analysis.pipeline.set_up_stages import SetUpStages
from analysis.results.set_up import rectangles
from analysis.results.store import Document
from analysis.topics.errors import parts as parts_of_pairs
from analysis.topics.machines import parts, truths
from analysis.topics.machines.set_ups import READING, SetUp
from geometries.scene.scene import Scene
from geometries.scene.writer import canonical

EVERY, FACING, REDUCED = "exact", "exact+facing", "reduced"
METHODS = (EVERY, FACING, REDUCED)
"""The methods whose change is compared with the true one."""
REDUCED_RTOL = 0.1
"""Relative error asked of the reduced method, which then prepares a machine in less than a second."""
_SECONDS = 1.0
_FILES = (
    "errors/paths.py",
    "errors/parts.py",
    "machines/parts.py",
    "machines/stage.py",
    "machines/truths.json",
)


def answer(set_up: SetUp, _: Path) -> Document:
    """Computes the changes (F) of the reading by each method, beside the true ones, which are solved only if they are not stored; and the model
    of sensor and target by themselves, None for a reading between sensors."""
    model = model_stage.model_module()
    true = truths.load().get(set_up.identity) or truths.solved(model, set_up)
    return {
        "changes": [{"included": chosen, **asdict(value)} for chosen, value in true.changes.changes.items()],
        "pairs": None if set_up.is_between_sensors else asdict(_pairs(model, set_up, true)),
        "methods": {method: _by(model, set_up, method) for method in methods(set_up)},
    }


def methods(set_up: SetUp) -> tuple[str, ...]:
    """Returns the methods that know a set-up's reading: the plain model knows none between two sensors."""
    return (REDUCED,) if set_up.is_between_sensors else METHODS


def _by(model: Any, set_up: SetUp, method: str) -> Document:
    """Computes a method's change; that of the plain model for the grounded target, since it knows no other one."""
    left_out = () if method == REDUCED else (parts.GROUNDING,)
    scene = parts.scenes(set_up, tuple(name for name in parts.COMPANY if name not in left_out))[0]
    loaded = model.Scene.loads(canonical(scene))
    before = perf_counter()
    try:
        reading = loaded.readings(**_options(method))[READING]
    except ValueError as error:
        return {"refused": str(error)}
    return {"change": float(reading.change), "seconds": perf_counter() - before}


def _options(method: str) -> dict[str, Any]:
    return {"method": method, "rtol": REDUCED_RTOL} if method == REDUCED else model_stage.options(method)


def _pairs(model: Any, set_up: SetUp, true: truths.Truths) -> parts.Pairs:
    """Evaluates the model of the sensor with each body of the target by itself, and takes its error apart if that is one plate."""
    scenes = parts.scenes(set_up, ())
    plates = rectangles(scenes[0]) if len(scenes) == 1 else None
    by_model = {method: sum(_model(model, scene, method) for scene in scenes) for method in (EVERY, FACING)}
    return parts.Pairs(
        truths=true.pairs,
        every=by_model[EVERY],
        facing=by_model[FACING],
        split=parts_of_pairs.split(model, *plates) if plates else None,
    )


def _model(model: Any, scene: Scene, method: str) -> float:
    return float(model.Scene.loads(canonical(scene)).readings(**model_stage.options(method))[READING].change)


STAGES = SetUpStages[SetUp](
    name="machines",
    what="set-ups on machines",
    rtol=truths.RTOL,
    sources=(*(f"analysis/topics/{file}" for file in _FILES), "analysis/results/set_up.py"),
    seconds=lambda _: _SECONDS,
    answer=answer,
)
