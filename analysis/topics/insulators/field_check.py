"""Readings of set-ups of Experiment VIII by the field solver and by boundary elements, kept beside this file.

The hand of each set-up is moved to the sensor's axis, so that the field solver meshes a quarter of space only.

`python3 -m analysis.topics.insulators.field_check [SECONDS]` solves covers, films and insulating targets that have no record in
`field_checks.json`, and begins none after these seconds. `... field_check boundary` solves those that have one anew by boundary elements. Delete the
file to solve all of them anew by both.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from analysis.pipeline import model_stage, reference_stage
from analysis.pipeline.processes import Processes
from analysis.pipeline.stage import NoAnswer
from analysis.results.answers import Estimate
from analysis.results.store import Document, read_json, write_json, write_text
from analysis.results.study_results import SCENE
from analysis.topics.insulators.set_ups import COVER, FILM, READING, TARGET, SetUp, all_set_ups
from geometries.common.children import temporary_folder
from geometries.scene.writer import canonical_and_identity

FILE = Path(__file__).with_name("field_checks.json")
QUANTITIES = ("value", "background", "change")
RTOL = 1e-2
"""Relative accuracy asked of both methods."""
GOAL = 5e-3
"""Largest difference, relative to the field solver's value, that the methods should have."""
_DIGITS = 7
_DESCRIPTION = (
    "Readings (F) of set-ups of Experiment VIII, their hands on the sensors' axes, by the field solver and by boundary elements asked for 1e-2, by the hash "
    "of the scene, with stated errors. Made by python3 -m analysis.topics.insulators.field_check."
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
    scene = replace(set_up.scene, objects=moved)
    text, identity = canonical_and_identity(scene)
    return replace(set_up, scene=scene, text=text, identity=identity)


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


def solve_again(file: Path = FILE) -> None:
    """Solves the set-ups that have a record anew by boundary elements."""
    records, model = _records(file), model_stage.model_module()
    for each in chosen():
        if each.identity in records:
            records[each.identity] |= _by_boundary_elements(model, each)
            write_json(file, {"description": _DESCRIPTION, "checks": records})


def solved(model: Any, processes: Processes, set_up: SetUp) -> Document:
    """Solves a set-up by both methods; NoAnswer if the field solver has none. `model` is the model's module."""
    document = _by_field(processes, set_up)
    (found,) = document["readings"]
    field = {name: {"value": found[name], "error": found["error"][name]} for name in QUANTITIES}
    return {
        "field": _rounded(field),
        "seconds": round(document["seconds"], 1),
        "unknowns": document["unknowns"],
        **_by_boundary_elements(model, set_up),
    }


def _by_boundary_elements(model: Any, set_up: SetUp) -> Document:
    reading = model.Scene.loads(set_up.text).readings("boundary-elements", rtol=RTOL)[READING]
    found = {name: {"value": getattr(reading, name), "error": reading.error[name]} for name in QUANTITIES}
    return {"boundary": _rounded(found)}


def _by_field(processes: Processes, set_up: SetUp) -> Document:
    with temporary_folder() as folder:
        scene = folder / SCENE
        write_text(scene, set_up.text)
        asked = ("--columns", set_up.scene.sensors[0].name, "--rtol", repr(RTOL))
        return reference_stage.solve(scene, processes, *asked)


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
    asked = sys.argv[1:] or ["inf"]
    if asked == ["boundary"]:
        solve_again()
    else:
        make(chosen(), float(asked[0]))
