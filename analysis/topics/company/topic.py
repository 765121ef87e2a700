"""Experiment VII as a topic: what company makes of a reading.

The field solver's readings of some set-ups are stored: `python3 -m analysis measure field-check company`, forty minutes of one core.
"""

from __future__ import annotations

from pathlib import Path

from analysis.pipeline.stage import NoAnswer
from analysis.report import page
from analysis.results.store import Document
from analysis.topics import field_solver
from analysis.topics.company import factors, section, set_ups
from analysis.topics.company.factors import Entry
from analysis.topics.company.set_ups import (
    ARRANGEMENTS,
    GUARD,
    MACHINES,
    PERSON,
    STAGES,
    TO_GROUND,
    SetUp,
    all_set_ups,
)
from analysis.topics.field_solver import FieldCheck
from analysis.topics.topic import Topic

MOST_UNKNOWNS = (550_000, 1_200_000)
"""Limits of a mesh's unknowns, tried in turn until two meshes have fewer; a third mesh mostly has more and would take minutes and gigabytes."""
# Steps in the arrangements' numbers from machine to machine and from connection to connection: with these all arrangements occur.
_BY_MACHINE, _BY_GROUND = 3, 2
_DESCRIPTION = (
    "Readings (F) of set-ups of Experiment VII by the field solver, by the hash of the scene, with estimated errors; seconds are elapsed. "
    "Made by python3 -m analysis measure field-check company."
)


def chosen() -> tuple[SetUp, ...]:
    """Returns one set-up for each machine and each connection of the hand, of all arrangements; those of large machines, the slowest, last."""
    numbers = {
        (machine, ground): 1 + (_BY_MACHINE * row + _BY_GROUND * column) % ARRANGEMENTS
        for row, machine in enumerate(MACHINES)
        for column, ground in enumerate(TO_GROUND)
    }
    found = [each for each in all_set_ups() if each.number == numbers[each.machine, each.ground]]
    return tuple(sorted(found, key=lambda each: (each.machine == GUARD, _is_large(each))))


def solved(set_up: SetUp) -> Document:
    """Solves a set-up for what its reading drives; NoAnswer if the field solver has none."""
    (asked_for,) = set_up.scene.readings
    asked = ("--error", "estimate", "--columns", ",".join(asked_for.drive))
    for most in MOST_UNKNOWNS[1:] if _is_large(set_up) else MOST_UNKNOWNS:
        document = field_solver.solved(set_up, *asked, "--max-unknowns", str(most))
        if len(document["levels"]) > 1:
            (reading,) = document["readings"]
            return {**field_solver.quantities_of(reading), "seconds": document["seconds"]}
    raise NoAnswer("one mesh has no estimated error")


def _is_large(set_up: SetUp) -> bool:
    return set_up.machine in (GUARD, PERSON)


CHECK = FieldCheck[SetUp](
    file=Path(__file__).with_name("field_checks.json"),
    description=_DESCRIPTION,
    chosen=chosen,
    solve=solved,
    kind=lambda each: each.machine,
    described=(
        ("set-up", lambda each: page.code(each.id)),
        ("in company of", lambda each: each.machine),
        ("hand", lambda each: each.ground),
    ),
    explanation=(
        "Its errors are estimates from two meshes, at least twice what the second one changes, or from three, extrapolated. "
        "python3 -m analysis measure field-check company makes them in forty minutes of one core."
    ),
)

COMPANY = Topic[SetUp, Entry](
    stages=STAGES,
    set_ups=lambda: set_ups.all_set_ups(),
    entry=factors.entry,
    sections=lambda found, checked, _: [section.section(found, checked)],
    finding=section.finding,
    absent=section.ABSENT,
    title="The model in company",
    question="What does a machine around the sensor change?",
    short="in company",
    reproduce="From the project's folder: the readings of a set-up, which is named as in the numbers, and those of all that have none yet.",
    check=CHECK,
)
