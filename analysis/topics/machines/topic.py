"""The model on machines as a topic.

The field solver's readings of some set-ups are stored: `python3 -m analysis measure field-check machines`, an hour of one core.
"""

from __future__ import annotations

from pathlib import Path

from analysis.results.store import Document
from analysis.topics import field_solver
from analysis.topics.field_solver import FieldCheck
from analysis.topics.machines import section, set_ups, truths
from analysis.topics.machines.section import Entry
from analysis.topics.machines.set_ups import SetUp, all_set_ups
from analysis.topics.machines.truths import STAGES
from analysis.topics.topic import Topic
from geometries.scene.shapes import Cuboid, PlateShape

_RTOL = 2e-2
"""Relative accuracy asked of the enclosures of value and background: the first mesh mostly has it."""
_MOST_UNKNOWNS = 400_000
"""Limit of a mesh's unknowns: more would take minutes."""
_DESCRIPTION = (
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


def solved(set_up: SetUp) -> Document:
    """Encloses the change of a set-up's reading; NoAnswer if the field solver has none."""
    (asked_for,) = set_up.scene.readings
    columns = dict.fromkeys([asked_for.sense, *asked_for.drive])
    asked = ("--rtol", repr(_RTOL), "--error", "enclosure", "--max-unknowns", str(_MOST_UNKNOWNS))
    document = field_solver.solved(set_up, *asked, "--columns", ",".join(columns))
    (reading,) = document["readings"]
    return {
        **field_solver.quantities_of(reading, ("change",)),
        "lower": reading["lower"]["change"],
        "upper": reading["upper"]["change"],
        "seconds": document["seconds"],
    }


CHECK = FieldCheck[SetUp](
    file=Path(__file__).with_name("field_checks.json"),
    description=_DESCRIPTION,
    chosen=chosen,
    solve=solved,
    kind=lambda each: each.family,
    described=(("set-up", lambda each: each.name), ("sealed", lambda each: "yes" if each.sealed else "")),
    explanation=(
        "The proven interval is the field solver's enclosure of the value less that of the background, so that it is wide where the change is a small part of the "
        "reading; its estimate of the change is far better. python3 -m analysis measure field-check machines makes the records in an hour of one core, for set-ups "
        "of boxes and plates, which it meshes quickly."
    ),
    quantities=("change",),
)

MACHINES = Topic[SetUp, Entry](
    stages=STAGES,
    set_ups=lambda: set_ups.all_set_ups(),
    entry=section.entry,
    sections=lambda found, checked, _: [section.section(found, checked)],
    finding=section.finding,
    absent=section.ABSENT,
    title="The model on machines",
    question="How wrong is the model on a machine?",
    short="on machines",
    reproduce=(
        "From the project's folder: the reading of a set-up, which is named as in the numbers; the comparison of all; and the true changes that are not stored."
    ),
    truths=truths.STORED,
    check=CHECK,
)
