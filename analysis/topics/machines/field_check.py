"""Changes of readings on machines enclosed by the field solver, kept beside this file.

`python3 -m analysis.topics.machines.field_check` solves the chosen set-ups that have no record in `field_checks.json`, in an hour of one
core for all of them. Delete the file to solve all of them anew.
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
from analysis.topics.machines.records import Entry
from analysis.topics.machines.set_ups import SetUp, all_set_ups
from geometries.common.children import temporary_folder
from geometries.scene.shapes import Cuboid, PlateShape

FILE = Path(__file__).with_name("field_checks.json")
_RTOL = 2e-2
"""Relative accuracy asked of the enclosures of value and background: the first mesh mostly has it."""
_MOST_UNKNOWNS = 400_000
"""Limit of a mesh's unknowns: more would take minutes."""
_DESCRIPTION = (
    "Changes of readings (F) on machines by the field solver, by the hash of the scene: value, estimated error, and the interval that is proven to "
    "contain it; seconds are elapsed. Made by python3 -m analysis.topics.machines.field_check."
)


@dataclass(frozen=True)
class FieldCheck:
    """The field solver's change of a reading, and the ends of the interval that contains it (F)."""

    change: Estimate
    lower: float
    upper: float
    seconds: float


@dataclass(frozen=True)
class Comparison:
    """The true change of a set-up by boundary elements, and the field solver's (F)."""

    set_up: SetUp
    change: Estimate
    field: FieldCheck

    @property
    def difference(self) -> float:
        """Boundary elements less the field solver, relative to the field solver's value."""
        return self.change.value / self.field.change.value - 1

    @property
    def allowed(self) -> float:
        """The sum of both stated errors, relative to the field solver's value."""
        return (self.change.error + self.field.change.error) / abs(self.field.change.value)

    @property
    def over_errors(self) -> float:
        """The difference over what both errors allow: above 1 one of the values, or its error, is wrong."""
        return abs(self.difference) / self.allowed

    @property
    def half_width(self) -> float:
        """Half the width of the proven interval, relative to the field solver's value."""
        return (self.field.upper - self.field.lower) / 2 / abs(self.field.change.value)

    @property
    def is_enclosed(self) -> bool:
        """Whether the value by boundary elements lies within the proven interval."""
        return self.field.lower <= self.change.value <= self.field.upper


def chosen() -> tuple[SetUp, ...]:
    """Returns the set-ups whose bodies are cuboids and plates only, which the field solver meshes quickly: those with few bodies, and of these
    the sealed ones, first."""
    flat = (
        each
        for each in all_set_ups()
        if all(isinstance(body.shape, (Cuboid, PlateShape)) for body in each.scene.objects)
    )
    return tuple(sorted(flat, key=lambda each: (len(each.scene.objects), not each.sealed)))


def load(file: Path = FILE) -> dict[str, FieldCheck]:
    """Returns the records by the identity of their set-up's scene; none without a file."""
    document = read_json(file)
    records: Document = {} if document is None else document["checks"]
    return {identity: _check(record) for identity, record in records.items()}


def comparisons(found: Iterable[Entry], checks: dict[str, FieldCheck]) -> list[Comparison]:
    """Pairs the entries that have a record with it, in the entries' order."""
    return [
        Comparison(entry.set_up, entry.change, checks[entry.set_up.identity])
        for entry in found
        if entry.set_up.identity in checks
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
            print(f"{each.name}: {reason}", file=sys.stderr)
            continue
        _write(file, records)
        print(f"{each.name}: {records[each.identity].seconds:.0f} s", file=sys.stderr)
    return len(chosen()) - len(records)


def solved(set_up: SetUp, processes: Processes) -> FieldCheck:
    """Encloses the change of a set-up's reading; NoAnswer if the field solver has none."""
    (asked_for,) = set_up.scene.readings
    columns = dict.fromkeys([asked_for.sense, *asked_for.drive])
    asked = ("--rtol", repr(_RTOL), "--error", "enclosure", "--max-unknowns", str(_MOST_UNKNOWNS))
    with temporary_folder() as folder:
        scene = folder / SCENE
        write_text(scene, set_up.text)
        document = reference_stage.solve(scene, processes, *asked, "--columns", ",".join(columns))
    (reading,) = document["readings"]
    return FieldCheck(
        Estimate(reading["change"], reading["error"]["change"]),
        reading["lower"]["change"],
        reading["upper"]["change"],
        document["seconds"],
    )


def _check(record: Document) -> FieldCheck:
    return FieldCheck(
        Estimate(**record["change"]), **{name: record[name] for name in ("lower", "upper", "seconds")}
    )


def _write(file: Path, records: dict[str, FieldCheck]) -> None:
    checks = {identity: asdict(record) for identity, record in records.items()}
    write_json(file, {"description": _DESCRIPTION, "checks": checks})


if __name__ == "__main__":
    sys.exit(1 if make() else 0)
