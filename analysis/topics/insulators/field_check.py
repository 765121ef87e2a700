"""Readings of set-ups of Experiment VIII by the field solver and by boundary elements, kept beside this file.

`python3 -m analysis.topics.insulators.field_check [SECONDS]` solves covers, films and insulating targets that have no record in
`field_checks.json`, in turn, and begins none after these seconds. Delete the file to solve all of them anew.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from analysis.pipeline import model_stage, reference_stage
from analysis.pipeline.processes import Processes
from analysis.pipeline.stage import NoAnswer
from analysis.results.answers import Estimate
from analysis.results.store import Document, read_json, write_json, write_text
from analysis.results.study_results import SCENE
from analysis.topics.insulators.set_ups import COVER, FILM, READING, TARGET, SetUp, all_set_ups

FILE = Path(__file__).with_name("field_checks.json")
QUANTITIES = ("value", "background", "change")
RTOL = 1e-2
"""Relative accuracy asked of boundary elements."""
GOAL = 5e-3
"""Largest difference, relative to the field solver's value, that the methods should have."""
MOST_UNKNOWNS = (600_000, 1_200_000)
"""Limits of a mesh's unknowns, tried in turn until two meshes have fewer."""
_DIGITS = 7
_DESCRIPTION = (
    "Readings (F) of set-ups of Experiment VIII by the field solver and by boundary elements asked for 1e-2, by the hash of the scene, with "
    "estimated errors. Made by python3 -m analysis.topics.insulators.field_check."
)


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
    """Returns the covers, films and insulating targets, the families in turn."""
    found = [each for each in all_set_ups() if each.family in (COVER, FILM, TARGET)]
    return tuple(sorted(found, key=lambda each: each.number))


def comparisons(file: Path = FILE) -> list[Comparison]:
    """Pairs the quantities of the set-ups that have a record."""
    records = _records(file)
    return [
        Comparison(
            each,
            quantity,
            *(Estimate(**records[each.identity][by][quantity]) for by in ("field", "boundary")),
        )
        for each in chosen()
        if each.identity in records
        for quantity in QUANTITIES
    ]


def make(set_ups: Iterable[SetUp], seconds: float = float("inf"), file: Path = FILE) -> int:
    """Solves the set-ups that have no record until the time has passed, and drops the records of none of `chosen`; returns how many of those given
    remain without one."""
    known, asked = _records(file), list(set_ups)
    records = {each.identity: known[each.identity] for each in chosen() if each.identity in known}
    model, processes, end = model_stage.model_module(), Processes(), time.monotonic() + seconds
    for each in asked:
        if each.identity in records or time.monotonic() >= end:
            continue
        try:
            records[each.identity] = solved(model, processes, each)
        except NoAnswer as reason:
            print(f"{each.name}: {reason}", file=sys.stderr, flush=True)
            continue
        write_json(file, {"description": _DESCRIPTION, "checks": records})
        print(f"{each.name}: {records[each.identity]['seconds']:.0f} s", file=sys.stderr, flush=True)
    return sum(each.identity not in records for each in asked)


def solved(model: Any, processes: Processes, set_up: SetUp) -> Document:
    """Solves a set-up by both methods; NoAnswer if the field solver has none. `model` is the model's module."""
    reading = model.Scene.loads(set_up.text).readings("boundary-elements", rtol=RTOL)[READING]
    boundary = {name: {"value": getattr(reading, name), "error": reading.error[name]} for name in QUANTITIES}
    document = _by_field(processes, set_up)
    (found,) = document["readings"]
    field = {name: {"value": found[name], "error": found["error"][name]} for name in QUANTITIES}
    return {
        "field": _rounded(field),
        "boundary": _rounded(boundary),
        "seconds": document["seconds"],
        "unknowns": document["unknowns"],
    }


def _by_field(processes: Processes, set_up: SetUp) -> Document:
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / SCENE
        write_text(scene, set_up.text)
        for most in MOST_UNKNOWNS:
            asked = ("--columns", set_up.scene.sensors[0].name, "--max-unknowns", str(most))
            document = reference_stage.solve(scene, processes, "--error", "estimate", *asked)
            if len(document["levels"]) > 1:
                return document
    raise NoAnswer("one mesh has no estimated error")


def _records(file: Path) -> Document:
    document = read_json(file)
    records: Document = {} if document is None else document["checks"]
    return records


def _rounded(quantities: dict[str, dict[str, float]]) -> Document:
    return {
        name: {key: float(f"{value:.{_DIGITS}g}") for key, value in estimate.items()}
        for name, estimate in quantities.items()
    }


if __name__ == "__main__":
    make(chosen(), float(sys.argv[1]) if len(sys.argv) > 1 else float("inf"))
