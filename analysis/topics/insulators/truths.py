"""The true readings of the set-ups of Experiment VIII, by boundary elements: `python3 -m analysis measure truths insulators`, a quarter of an hour.

The field solver's readings of some set-ups are stored: `python3 -m analysis measure field-check insulators`, minutes for each set-up.
The hand of each is moved to the sensor's axis, so that the field solver meshes a quarter of space only.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from analysis.pipeline import model_stage
from analysis.pipeline.set_up_stages import SetUpStages
from analysis.results.answers import Estimate
from analysis.results.store import Document
from analysis.topics import field_solver
from analysis.topics.field_solver import QUANTITIES, FieldCheck
from analysis.topics.insulators.set_ups import COVER, FILM, MATTRESS, READING, TARGET, SetUp, all_set_ups
from analysis.topics.stored import Stored, rounded
from geometries.scene.scene import Scene
from geometries.scene.writer import canonical

RTOL = 5e-2
"""Relative accuracy asked of every entry of the Maxwell matrix and of the reading's change."""
RTOL_OF_LAYERS = 3e-2
"""The same of covers and films, by which the layer rule is measured."""
_DESCRIPTION = (
    "Readings (F) of set-ups with insulators by boundary elements, by the hash of the scene, with stated errors: value without the target and change "
    "by it; with the insulator and without. Made by python3 -m analysis measure truths insulators."
)


@dataclass(frozen=True)
class Truth:
    """The reading without the target, and its change by the target."""

    background: Estimate
    change: Estimate


@dataclass(frozen=True)
class Truths:
    """A set-up's truth with the insulator and without it."""

    insulated: Truth
    without: Truth


@cache
def load() -> dict[str, Truths]:
    """Returns the records by the identity of their set-up's scene; none without a file."""
    return {identity: read(record) for identity, record in STORED.records().items()}


def solved(model: Any, set_up: SetUp) -> Truths:
    """Solves a set-up with the insulator and without it. `model` is the model's module."""
    rtol = RTOL_OF_LAYERS if set_up.family in (COVER, FILM) else RTOL
    return Truths(_solved(model, set_up.scene, rtol), _solved(model, set_up.without, rtol))


def _solved(model: Any, scene: Scene, rtol: float) -> Truth:
    (reading,) = model.Scene.loads(canonical(scene)).maxwell(rtol=rtol)["readings"]
    return Truth(
        *(Estimate(float(reading[key]), float(reading["error"][key])) for key in ("background", "change"))
    )


def read(record: Document) -> Truths:
    """Reads stored truths."""
    return Truths(
        *(
            Truth(*(Estimate(**record[place][key]) for key in ("background", "change")))
            for place in ("insulated", "without")
        )
    )


STORED = Stored[SetUp](
    file=Path(__file__).with_name("truths.json"),
    description=_DESCRIPTION,
    chosen=all_set_ups,
    solve=lambda each: rounded(asdict(solved(model_stage.model_module(), each))),
)


REDUCED, IGNORING = "reduced", "reduced without the layer"


_RTOL = 0.1
"""Relative error asked of the reduced method, which then prepares a set-up in less than a second."""
_SECONDS = 0.3


def answer(set_up: SetUp, _: Path) -> Document:
    """Computes the model's changes (F) of the reading beside the true ones, which are solved only if they are not stored."""
    model = model_stage.model_module()
    true = load().get(set_up.identity) or solved(model, set_up)
    changes = {IGNORING: _change(model, set_up.without)}
    # A dielectric body of the machine takes the reduced method longer to prepare than boundary elements take.
    is_slow = set_up.family == MATTRESS
    changes[REDUCED] = {"refused": "left to boundary elements"} if is_slow else _change(model, set_up.scene)
    return {"truths": asdict(true), "changes": changes}


def _change(model: Any, scene: Scene) -> Document:
    try:
        reading = model.Scene.loads(canonical(scene)).readings(method=REDUCED, rtol=_RTOL)[READING]
    except ValueError as error:
        return {"refused": str(error)}
    if reading.error["change"] is None:
        return {"refused": "its error is not known"}
    return {"value": float(reading.change), "error": float(reading.error["change"])}


STAGES = SetUpStages[SetUp](
    name="insulators",
    what="set-ups with insulators",
    rtol=RTOL,
    sources=tuple(f"analysis/topics/insulators/{name}" for name in ("truths.py", "truths.json")),
    seconds=lambda _: _SECONDS,
    answer=answer,
)


RTOL_OF_CHECKS = 1e-2
"""Relative accuracy asked of both methods."""
_DESCRIPTION_OF_CHECKS = (
    "Readings (F) of set-ups of Experiment VIII, their hands on the sensors' axes, by the field solver and by boundary elements asked for 1e-2, by the hash "
    "of the scene, with stated errors. Made by python3 -m analysis measure field-check insulators."
)


@cache
def chosen() -> tuple[SetUp, ...]:
    """Returns the insulating targets, covers and films with their hands on the axis: those first that take the fewest cells."""
    found = [centred(each) for each in all_set_ups() if each.family in (COVER, FILM, TARGET)]
    return tuple(sorted(found, key=lambda each: each.size / each.thickness))


def centred(set_up: SetUp) -> SetUp:
    """Returns the set-up with its hand on the sensor's axis, with the insulator only."""
    moved = tuple(
        replace(body, pose=replace(body.pose, translation=(0.0, 0.0, body.pose.translation[2])))
        for body in set_up.scene.objects
    )
    return replace(set_up, scene=replace(set_up.scene, objects=moved))


def checked(set_up: SetUp) -> Document:
    """Solves a set-up by both methods; NoAnswer if the field solver has none."""
    asked = ("--columns", set_up.scene.sensors[0].name, "--rtol", repr(RTOL_OF_CHECKS))
    document = field_solver.solved(set_up, *asked)
    (found,) = document["readings"]
    return {
        "field": rounded(field_solver.quantities_of(found)),
        "seconds": round(document["seconds"], 1),
        "unknowns": document["unknowns"],
        **by_boundary_elements(set_up),
    }


def solve_again() -> int:
    """Solves the set-ups that have a record anew by boundary elements; returns how many."""
    kept = CHECK.records()
    recorded = [each for each in chosen() if each.identity in kept]
    for each in recorded:
        kept[each.identity] |= by_boundary_elements(each)
        CHECK.write(kept)
    return len(recorded)


def by_boundary_elements(set_up: SetUp) -> Document:
    """Returns what a record has of a set-up by boundary elements."""
    model = model_stage.model_module()
    reading = model.Scene.loads(set_up.text).readings("boundary-elements", rtol=RTOL_OF_CHECKS)[READING]
    found = {name: {"value": getattr(reading, name), "error": reading.error[name]} for name in QUANTITIES}
    return {"boundary": rounded(found)}


CHECK = FieldCheck[SetUp](
    file=Path(__file__).with_name("field_checks.json"),
    description=_DESCRIPTION_OF_CHECKS,
    chosen=chosen,
    solve=checked,
    kind=lambda each: each.family,
    described=(("set-up", lambda each: each.name),),
    explanation="The hands are moved to the sensors' axes, where the field solver meshes a quarter of space.",
    both=True,
)
