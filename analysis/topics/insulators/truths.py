"""The true readings of the set-ups of Experiment VIII, by boundary elements, kept beside this file.

`python3 -m analysis.topics.insulators.truths` solves the set-ups that have no record in `truths.json`, in a quarter of an hour of one core for
all of them. Delete the file to solve all of them anew.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

from analysis.pipeline import model_stage
from analysis.results.answers import Estimate
from analysis.results.store import Document, read_json, write_json
from analysis.topics.insulators.set_ups import COVER, FILM, HAND, SENSOR, SetUp, all_set_ups
from geometries.scene.scene import Scene
from geometries.scene.writer import canonical

FILE = Path(__file__).with_name("truths.json")
RTOL = 5e-2
"""Relative accuracy asked of every entry of the Maxwell matrix and of the reading's change."""
RTOL_OF_LAYERS = 3e-2
"""The same of covers and films, by which the layer rule is measured."""
_DIGITS = 7
"""Significant digits of a stored value: far more than are true."""
_DESCRIPTION = (
    "Readings (F) of set-ups with insulators by boundary elements, by the hash of the scene, with stated errors: value without the target, change by "
    "it, and the charge on the hand per volt; with the insulator and without. Made by python3 -m analysis.topics.insulators.truths."
)


@dataclass(frozen=True)
class Truth:
    """The reading without the target, its change by the target, and the charge on the hand per volt; None for an insulating target."""

    background: Estimate
    change: Estimate
    mutual: Estimate | None


@dataclass(frozen=True)
class Truths:
    """A set-up's truth with the insulator and without it."""

    insulated: Truth
    without: Truth


@cache
def load(file: Path = FILE) -> dict[str, Truths]:
    """Returns the records by the identity of their set-up's scene; none without a file."""
    return {
        identity: Truths(*(_truth(record[key]) for key in ("insulated", "without")))
        for identity, record in _records(file).items()
    }


def make(set_ups: Iterable[SetUp] | None = None, file: Path = FILE) -> int:
    """Solves the set-ups, all if none are given, that have no record, and drops the records of others; returns how many were solved."""
    chosen = list(all_set_ups() if set_ups is None else set_ups)
    known, model, count = _records(file), model_stage.model_module(), 0
    records = {each.identity: known[each.identity] for each in chosen if each.identity in known}
    for each in chosen:
        if each.identity not in records:
            records[each.identity] = _rounded(asdict(solved(model, each)))
            _write(file, records)
            count += 1
            print(f"{each.name}: solved", file=sys.stderr, flush=True)
    if records.keys() != known.keys():
        _write(file, records)
    return count


def solved(model: Any, set_up: SetUp) -> Truths:
    """Solves a set-up with the insulator and without it. `model` is the model's module."""
    rtol = RTOL_OF_LAYERS if set_up.family in (COVER, FILM) else RTOL
    return Truths(_solved(model, set_up.scene, rtol), _solved(model, set_up.without, rtol))


def _solved(model: Any, scene: Scene, rtol: float) -> Truth:
    answer = model.Scene.loads(canonical(scene)).maxwell(rtol=rtol)
    (reading,) = answer["readings"]
    background, change = (
        Estimate(float(reading[key]), float(reading["error"][key])) for key in ("background", "change")
    )
    names = list(answer["conductors"])
    grounded = next((k for k, members in enumerate(answer["members"]) if HAND in members), None)
    if grounded is None:
        return Truth(background, change, None)
    row = names.index(SENSOR)
    entry, error = answer["maxwell"][row][grounded], answer["error"][row][grounded]
    return Truth(background, change, Estimate(-float(entry), float(error)))


def _records(file: Path) -> Document:
    document = read_json(file)
    records: Document = {} if document is None else document["truths"]
    return records


def _truth(record: Document) -> Truth:
    estimates = (
        Estimate(**record[key]) if record[key] else None for key in ("background", "change", "mutual")
    )
    background, change, mutual = estimates
    assert background is not None and change is not None
    return Truth(background, change, mutual)


def _rounded(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _rounded(each) for key, each in value.items()}
    return float(f"{value:.{_DIGITS}g}") if isinstance(value, float) else value


def _write(file: Path, records: Document) -> None:
    write_json(file, {"description": _DESCRIPTION, "truths": records})


if __name__ == "__main__":
    make()
