"""The true changes of the set-ups on machines, by boundary elements: `python3 -m analysis measure truths machines`, a quarter of an hour of two cores.

The field solver's readings of some set-ups are stored: `python3 -m analysis measure field-check machines`, an hour of one core.
"""

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
from analysis.topics.machines.set_ups import READING, SetUp, all_set_ups
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

    changes: parts.OnMachine
    pairs: tuple[Truth, ...]


@cache
def load() -> dict[str, Truths]:
    """Returns the records by the identity of their set-up's scene; none without a file."""
    return {
        identity: Truths(parts.OnMachine.read(record["changes"]), tuple(map(Truth.read, record["pairs"])))
        for identity, record in STORED.records().items()
    }


def solved(model: Any, set_up: SetUp) -> Truths:
    """Solves a set-up for every choice of what is included. `model` is the model's module."""
    if set_up.is_between_sensors:
        return Truths(parts.OnMachine(_changes(model, set_up, parts.choices(set_up))), ())
    alone = parts.scenes(set_up, ())
    plates = len(alone) == 1 and rectangles(alone[0]) is not None
    rtol = _RTOL_OF_PLATES if plates else RTOL
    solutions = (model.Scene.loads(canonical(scene)).maxwell(rtol=rtol) for scene in alone)
    pairs = tuple(Truth.of(solution, alone[0].sensors[0].name) for solution in solutions)
    changes: dict[tuple[str, ...], Estimate] = {(): parts.added(pair.delta_self for pair in pairs)}
    changes |= _changes(model, set_up, (chosen for chosen in parts.choices(set_up) if chosen))
    return Truths(parts.OnMachine(changes), pairs)


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


def _document(truths: Truths) -> Document:
    return {"changes": truths.changes.documents(), "pairs": [asdict(pair) for pair in truths.pairs]}


STORED = stored.Stored[SetUp](
    file=Path(__file__).with_name("truths.json"),
    description=_DESCRIPTION,
    chosen=all_set_ups,
    solve=lambda each: stored.rounded(_document(solved(model_stage.model_module(), each))),
)

EVERY, FACING, REDUCED = "exact", "exact+facing", "reduced"
METHODS = (EVERY, FACING, REDUCED)
"""The methods whose change is compared with the true one."""
REDUCED_RTOL = 0.1
"""Relative error asked of the reduced method, which then prepares a machine in less than a second."""
_SECONDS = 1.0
_FILES = ("errors/parts.py", "machines/parts.py", "machines/truths.py", "machines/truths.json")


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
    included = tuple(name for name in parts.COMPANY if method == REDUCED or name != parts.GROUNDING)
    options = model_stage.options(method)
    if method == REDUCED:
        options = {"method": method, "rtol": REDUCED_RTOL}
    loaded = model.Scene.loads(canonical(parts.scenes(set_up, included)[0]))
    before = perf_counter()
    try:
        reading = loaded.readings(**options)[READING]
    except ValueError as error:
        return {"refused": str(error)}
    if reading.change is None:
        return {"refused": "the change is not known"}
    return {"change": float(reading.change), "seconds": perf_counter() - before}


def _pairs(model: Any, set_up: SetUp, true: Truths) -> parts.Pairs:
    """Evaluates the model of the sensor with each body of the target by itself, and takes its error apart if that is one plate."""
    scenes = parts.scenes(set_up, ())
    plates = rectangles(scenes[0]) if len(scenes) == 1 else None
    loaded = [model.Scene.loads(canonical(scene)) for scene in scenes]
    asked = [model_stage.options(method) for method in (EVERY, FACING)]
    every, facing = (sum(float(scene.readings(**each)[READING].change) for scene in loaded) for each in asked)
    return parts.Pairs(true.pairs, every, facing, split(model, *plates) if plates else None)


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
    flat = (Cuboid, PlateShape)
    found = (
        each for each in all_set_ups() if all(isinstance(body.shape, flat) for body in each.scene.objects)
    )
    return tuple(sorted(found, key=lambda each: (len(each.scene.objects), not each.sealed)))


def checked(set_up: SetUp) -> Document:
    """Encloses the change of a set-up's reading; NoAnswer if the field solver has none."""
    (asked_for,) = set_up.scene.readings
    columns = dict.fromkeys([asked_for.sense, *asked_for.drive])
    asked = ("--rtol", repr(_RTOL_OF_CHECKS), "--error", "enclosure", "--max-unknowns", str(_MOST_UNKNOWNS))
    reading, document = stored.solved(set_up, *asked, "--columns", ",".join(columns))
    return {
        **stored.quantities_of(reading, ("change",)),
        "lower": reading["lower"]["change"],
        "upper": reading["upper"]["change"],
        "seconds": document["seconds"],
    }


CHECK = stored.FieldCheck[SetUp](
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
