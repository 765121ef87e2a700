"""Experiment VIII as a topic: what insulators before a sensor make of its reading.

The field solver's readings of some set-ups are stored: `python3 -m analysis measure field-check insulators`, minutes for each set-up.
The hand of each is moved to the sensor's axis, so that the field solver meshes a quarter of space only.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

from analysis.pipeline import model_stage
from analysis.results.store import Document
from analysis.topics import field_solver
from analysis.topics.field_solver import QUANTITIES, FieldCheck
from analysis.topics.insulators import section, set_ups, truths
from analysis.topics.insulators.section import Entry
from analysis.topics.insulators.set_ups import COVER, FILM, READING, TARGET, SetUp, all_set_ups
from analysis.topics.insulators.truths import STAGES
from analysis.topics.stored import rounded
from analysis.topics.topic import Topic

RTOL = 1e-2
"""Relative accuracy asked of both methods."""
_DESCRIPTION = (
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


def solved(set_up: SetUp) -> Document:
    """Solves a set-up by both methods; NoAnswer if the field solver has none."""
    asked = ("--columns", set_up.scene.sensors[0].name, "--rtol", repr(RTOL))
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
    reading = model.Scene.loads(set_up.text).readings("boundary-elements", rtol=RTOL)[READING]
    found = {name: {"value": getattr(reading, name), "error": reading.error[name]} for name in QUANTITIES}
    return {"boundary": rounded(found)}


CHECK = FieldCheck[SetUp](
    file=Path(__file__).with_name("field_checks.json"),
    description=_DESCRIPTION,
    chosen=chosen,
    solve=solved,
    kind=lambda each: each.family,
    described=(("set-up", lambda each: each.name),),
    explanation="The hands are moved to the sensors' axes, where the field solver meshes a quarter of space.",
    both=True,
)

INSULATORS = Topic[SetUp, Entry](
    stages=STAGES,
    set_ups=lambda: set_ups.all_set_ups(),
    entry=section.entry,
    sections=lambda found, checked, _: [section.section(found, checked)],
    finding=section.finding,
    absent=section.ABSENT,
    title="The model before insulators",
    question="What do insulators before a sensor change?",
    short="insulators",
    reproduce=(
        "From the project's folder: the reading of a set-up, which is named as in the numbers; the comparison of all; and the true changes and the field "
        "solver's readings that are not stored."
    ),
    truths=truths.STORED,
    check=CHECK,
    is_quick=True,
)
