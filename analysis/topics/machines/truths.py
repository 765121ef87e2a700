"""The true changes of the set-ups on machines, by boundary elements: `python3 -m analysis measure truths machines`, a quarter of an hour of two cores.

The field solver's readings of some set-ups are stored: `python3 -m analysis measure field-check machines`, an hour of one core.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from time import perf_counter
from typing import Any

from analysis.pipeline import model_stage
from analysis.pipeline.set_up_stages import SetUpStages
from analysis.results.answers import Estimate
from analysis.results.set_up import rectangles
from analysis.results.store import Document
from analysis.topics import stored
from analysis.topics.errors.parts import Truth, split
from analysis.topics.machines import parts
from analysis.topics.machines.parts import OnMachine
from analysis.topics.machines.set_ups import READING, SetUp, all_set_ups
from analysis.topics.stored import FieldCheck, Stored, rounded
from geometries.scene.scene import Scene
from geometries.scene.shapes import Cuboid, PlateShape
from geometries.scene.writer import canonical

RTOL = 1e-1
"""Relative accuracy asked of a true change: the model is wrong by far more, and what is stated is mostly several times the true error."""
_RTOL_BETWEEN = 2e-1
"""That of the changes with something left out, which only the sizes of the parts depend on."""
_RTOL_OF_PLATES = 1e-3
"""That of one plate before another, whose error has smaller parts; it costs milliseconds."""
_DESCRIPTION = (
    "True changes (F) of set-ups on machines by boundary elements, by the hash of the scene, with stated errors, for each choice of what is included; "
    "and sensor and target by themselves. Made by python3 -m analysis measure truths machines."
)


@dataclass(frozen=True)
class Truths:
    """The true changes of a set-up, and the truth of the sensor with each body of the target by itself, empty for a reading between sensors."""

    changes: OnMachine
    pairs: tuple[Truth, ...]


@cache
def load() -> dict[str, Truths]:
    """Returns the records by the identity of their set-up's scene; none without a file."""
    return {identity: _truths(record) for identity, record in STORED.records().items()}


def solved(model: Any, set_up: SetUp) -> Truths:
    """Solves a set-up for every choice of what is included. `model` is the model's module."""
    if set_up.is_between_sensors:
        return Truths(OnMachine(_changes(model, set_up, parts.choices(set_up))), ())
    alone = parts.scenes(set_up, ())
    plates = len(alone) == 1 and rectangles(alone[0]) is not None
    pairs = tuple(_pair(model, scene, _RTOL_OF_PLATES if plates else RTOL) for scene in alone)
    changes: dict[tuple[str, ...], Estimate] = {(): parts.added(pair.delta_self for pair in pairs)}
    changes |= _changes(model, set_up, (chosen for chosen in parts.choices(set_up) if chosen))
    return Truths(OnMachine(changes), pairs)


def _changes(
    model: Any, set_up: SetUp, choices: Iterable[tuple[str, ...]]
) -> dict[tuple[str, ...], Estimate]:
    everything = parts.included(set_up)
    return {
        chosen: parts.added(
            _change(model, scene, RTOL if chosen == everything else _RTOL_BETWEEN)
            for scene in parts.scenes(set_up, chosen)
        )
        for chosen in choices
    }


def _change(model: Any, scene: Scene, rtol: float) -> Estimate:
    reading = model.Scene.loads(canonical(scene)).readings("boundary-elements", rtol=rtol)[READING]
    return Estimate(float(reading.change), float(reading.error["change"]))


def _pair(model: Any, scene: Scene, rtol: float) -> Truth:
    return Truth.of(model.Scene.loads(canonical(scene)).maxwell(rtol=rtol), scene.sensors[0].name)


def _truths(record: Document) -> Truths:
    return Truths(OnMachine.read(record["changes"]), tuple(map(Truth.read, record["pairs"])))


def _record(truths: Truths) -> Document:
    return rounded({"changes": truths.changes.documents(), "pairs": [asdict(pair) for pair in truths.pairs]})


STORED = Stored[SetUp](
    file=Path(__file__).with_name("truths.json"),
    description=_DESCRIPTION,
    chosen=all_set_ups,
    solve=lambda each: _record(solved(model_stage.model_module(), each)),
)


EVERY, FACING, REDUCED = "exact", "exact+facing", "reduced"
METHODS = (EVERY, FACING, REDUCED)
"""The methods whose change is compared with the true one."""
REDUCED_RTOL = 0.1
"""Relative error asked of the reduced method, which then prepares a machine in less than a second."""
_SECONDS = 1.0
_FILES = (
    "errors/parts.py",
    "machines/parts.py",
    "machines/truths.py",
    "machines/truths.json",
)


def answer(set_up: SetUp, _: Path) -> Document:
    """Computes the changes (F) of the reading by each method, beside the true ones, which are solved only if they are not stored; and the model
    of sensor and target by themselves, None for a reading between sensors."""
    model = model_stage.model_module()
    true = load().get(set_up.identity) or solved(model, set_up)
    return {
        "changes": true.changes.documents(),
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
    if reading.change is None:
        return {"refused": "the change is not known"}
    return {"change": float(reading.change), "seconds": perf_counter() - before}


def _options(method: str) -> dict[str, Any]:
    return {"method": method, "rtol": REDUCED_RTOL} if method == REDUCED else model_stage.options(method)


def _pairs(model: Any, set_up: SetUp, true: Truths) -> parts.Pairs:
    """Evaluates the model of the sensor with each body of the target by itself, and takes its error apart if that is one plate."""
    scenes = parts.scenes(set_up, ())
    plates = rectangles(scenes[0]) if len(scenes) == 1 else None
    by_model = {method: sum(_model(model, scene, method) for scene in scenes) for method in (EVERY, FACING)}
    return parts.Pairs(
        truths=true.pairs,
        every=by_model[EVERY],
        facing=by_model[FACING],
        split=split(model, *plates) if plates else None,
    )


def _model(model: Any, scene: Scene, method: str) -> float:
    return float(model.Scene.loads(canonical(scene)).readings(**model_stage.options(method))[READING].change)


STAGES = SetUpStages[SetUp](
    name="machines",
    what="set-ups on machines",
    rtol=RTOL,
    sources=(*(f"analysis/topics/{file}" for file in _FILES), "analysis/results/set_up.py"),
    seconds=lambda _: _SECONDS,
    answer=answer,
)


_RTOL_OF_CHECKS = 2e-2
"""Relative accuracy asked of the enclosures of value and background: the first mesh mostly has it."""
_MOST_UNKNOWNS = 400_000
"""Limit of a mesh's unknowns: more would take minutes."""
_DESCRIPTION_OF_CHECKS = (
    "Changes of readings (F) on machines by the field solver, by the hash of the scene: value, estimated error, and the interval that is proven to "
    "contain it; seconds are elapsed. Made by python3 -m analysis measure field-check machines."
)


def chosen() -> tuple[SetUp, ...]:
    """Returns the set-ups whose bodies are cuboids and plates only, which the field solver meshes quickly: those with few bodies, and of these
    the sealed ones, first."""
    flat = (
        each
        for each in all_set_ups()
        if all(isinstance(body.shape, (Cuboid, PlateShape)) for body in each.scene.objects)
    )
    return tuple(sorted(flat, key=lambda each: (len(each.scene.objects), not each.sealed)))


def checked(set_up: SetUp) -> Document:
    """Encloses the change of a set-up's reading; NoAnswer if the field solver has none."""
    (asked_for,) = set_up.scene.readings
    columns = dict.fromkeys([asked_for.sense, *asked_for.drive])
    asked = ("--rtol", repr(_RTOL_OF_CHECKS), "--error", "enclosure", "--max-unknowns", str(_MOST_UNKNOWNS))
    document = stored.solved(set_up, *asked, "--columns", ",".join(columns))
    (reading,) = document["readings"]
    return {
        **stored.quantities_of(reading, ("change",)),
        "lower": reading["lower"]["change"],
        "upper": reading["upper"]["change"],
        "seconds": document["seconds"],
    }


CHECK = FieldCheck[SetUp](
    file=Path(__file__).with_name("field_checks.json"),
    description=_DESCRIPTION_OF_CHECKS,
    chosen=chosen,
    solve=checked,
    kind=lambda each: each.family,
    described=(("set-up", lambda each: each.name), ("sealed", lambda each: "yes" if each.sealed else "")),
    explanation=(
        "The proven interval is the field solver's enclosure of the value less that of the background, so that it is wide where the change is a small part of the "
        "reading; its estimate of the change is far better. python3 -m analysis measure field-check machines makes the records in an hour of one core, for set-ups "
        "of boxes and plates, which it meshes quickly."
    ),
    quantities=("change",),
)
