"""Readings of some set-ups of Experiment VII by the field solver, kept beside this file.

`python3 -m analysis.topics.company.field_check` solves the set-ups that have no record in `field_checks.json`, in
forty minutes of one core for all of them. Delete the file to solve all of them anew.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path

from analysis.pipeline import reference_stage
from analysis.pipeline.processes import Processes
from analysis.pipeline.stage import NoAnswer
from analysis.results.answers import Estimate
from analysis.results.store import Document, read_json, write_json, write_text
from analysis.results.study_results import SCENE
from analysis.topics.company.factors import Entry
from analysis.topics.company.set_ups import (
    ARRANGEMENTS,
    GUARD,
    MACHINES,
    PERSON,
    TO_GROUND,
    SetUp,
    all_set_ups,
)
from geometries.common.children import temporary_folder

FILE = Path(__file__).with_name("field_checks.json")
MOST_UNKNOWNS = (550_000, 1_200_000)
"""Limits of a mesh's unknowns, tried in turn until two meshes have fewer; a third mesh mostly has more and would take minutes and gigabytes."""
QUANTITIES = ("value", "background", "change")
# Steps in the arrangements' numbers from machine to machine and from connection to connection: with these all arrangements occur.
_BY_MACHINE, _BY_GROUND = 3, 2
_DESCRIPTION = (
    "Readings (F) of set-ups of Experiment VII by the field solver, by the hash of the scene, with estimated errors; seconds are elapsed. "
    "Made by python3 -m analysis.topics.company.field_check."
)


@dataclass(frozen=True)
class FieldCheck:
    """The field solver's reading of a set-up: value, background and change (F)."""

    value: Estimate
    background: Estimate
    change: Estimate
    seconds: float


@dataclass(frozen=True)
class Comparison:
    """One quantity of a set-up's reading by both methods (F)."""

    set_up: SetUp
    quantity: str
    field: Estimate
    boundary: Estimate

    @property
    def difference(self) -> float:
        """Boundary elements less the field solver, relative to the field solver's value."""
        return self.boundary.value / self.field.value - 1

    @property
    def allowed(self) -> float:
        """The sum of both errors, relative to the field solver's value."""
        return (self.boundary.error + self.field.error) / self.field.value

    @property
    def over_errors(self) -> float:
        """The difference over what both errors allow: above 1 one of the values, or its error, is wrong."""
        return abs(self.difference) / self.allowed


def chosen() -> tuple[SetUp, ...]:
    """Returns one set-up for each machine and each connection of the hand, of all arrangements; those of large machines, the slowest, last."""
    numbers = {
        (machine, ground): 1 + (_BY_MACHINE * row + _BY_GROUND * column) % ARRANGEMENTS
        for row, machine in enumerate(MACHINES)
        for column, ground in enumerate(TO_GROUND)
    }
    found = [each for each in all_set_ups() if each.number == numbers[each.machine, each.ground]]
    return tuple(sorted(found, key=lambda each: (each.machine == GUARD, _is_large(each))))


def load(file: Path = FILE) -> dict[str, FieldCheck]:
    """Returns the records by the identity of their set-up's scene; none without a file."""
    document = read_json(file)
    if document is None:
        return {}
    return {identity: _check(record) for identity, record in document["checks"].items()}


def comparisons(found: Iterable[Entry], checks: dict[str, FieldCheck]) -> list[Comparison]:
    """Pairs the quantities of the entries that have a record, in the entries' order."""
    return [
        Comparison(
            entry.set_up,
            quantity,
            getattr(checks[entry.set_up.identity], quantity),
            getattr(entry, quantity),
        )
        for entry in found
        if entry.set_up.identity in checks
        for quantity in QUANTITIES
    ]


def make(file: Path = FILE) -> int:
    """Solves the chosen set-ups that have no record, and drops the records of others; returns how many remain without."""
    known, processes = load(file), Processes()
    records = {each.identity: known[each.identity] for each in chosen() if each.identity in known}
    for each in chosen():
        if each.identity in records:
            continue
        try:
            records[each.identity] = solved(each, processes)
        except NoAnswer as reason:
            print(f"set-up {each.id}: {reason}", file=sys.stderr)
            continue
        _write(file, records)
        print(f"set-up {each.id}: {records[each.identity].seconds:.0f} s", file=sys.stderr)
    return len(chosen()) - len(records)


def solved(set_up: SetUp, processes: Processes) -> FieldCheck:
    """Solves a set-up for what its reading drives; NoAnswer if the field solver has none."""
    (asked_for,) = set_up.scene.readings
    with temporary_folder() as folder:
        scene = folder / SCENE
        write_text(scene, set_up.text)
        for most in MOST_UNKNOWNS[1:] if _is_large(set_up) else MOST_UNKNOWNS:
            asked = ("--columns", ",".join(asked_for.drive), "--max-unknowns", str(most))
            document = reference_stage.solve(scene, processes, "--error", "estimate", *asked)
            if len(document["levels"]) > 1:
                break
        else:
            raise NoAnswer("one mesh has no estimated error")
    (reading,) = document["readings"]
    quantities = {name: Estimate(reading[name], reading["error"][name]) for name in QUANTITIES}
    return FieldCheck(**quantities, seconds=document["seconds"])


def _is_large(set_up: SetUp) -> bool:
    return set_up.machine in (GUARD, PERSON)


def _check(record: Document) -> FieldCheck:
    return FieldCheck(**{name: Estimate(**record[name]) for name in QUANTITIES}, seconds=record["seconds"])


def _write(file: Path, records: dict[str, FieldCheck]) -> None:
    checks = {identity: asdict(record) for identity, record in records.items()}
    write_json(file, {"description": _DESCRIPTION, "checks": checks})


if __name__ == "__main__":
    sys.exit(1 if make() else 0)
