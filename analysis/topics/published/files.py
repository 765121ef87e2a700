"""Reads the table and its checks, CSV files that are kept with the project; TABLE.md tells how they were made."""

from __future__ import annotations

import csv
import hashlib
import io
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analysis.results.set_up import Rectangle
from geometries.studies import study
from geometries.studies.study import EMPTY, Case

MUTUAL, SENSOR, TARGET, DELTA_SELF = "mutual", "self_sensor", "self_target", "delta_self"
QUANTITIES = (MUTUAL, SENSOR, TARGET, DELTA_SELF)


@dataclass(frozen=True)
class Value:
    """Picofarad: the best value with its stated error, and the bounds."""

    best: float
    error: float
    low: float
    high: float

    @property
    def half_width(self) -> float:
        """Half the width of the interval, relative to the best value."""
        return (self.high - self.low) / (2 * self.best)


@dataclass(frozen=True, eq=False)
class Row:
    """One set-up. `parameters` are those of its family, in metres and degrees; `target` is the plate in the sensor's frame."""

    case: str
    family: str
    parameters: dict[str, float]
    target: Rectangle
    values: dict[str, Value]


def worst_error(found: Iterable[Row]) -> float:
    """Returns the largest relative stated error of the best values."""
    return max(value.error / value.best for row in found for value in row.values.values())


PLACE = Path(__file__).parent
"""The folder of the published table."""
TABLE, CHECKS, PAGE = "reference_table.csv", "checks.csv", "TABLE.md"
STUDY = "published"

_LENGTHS = ("target_x", "target_y", "gap", "height")
_ANGLES = ("tilt_degrees", "turn_degrees")
_VECTORS = ("corner", "edge_u", "edge_v")
_PARTS = {"": "best", "_error": "error", "_low": "low", "_high": "high"}


@dataclass(frozen=True)
class Check:
    """A value of the field solver and of the table (pF), each with its error."""

    case: str
    quantity: str
    value: float
    error: float
    best: float
    best_error: float

    @property
    def difference(self) -> float:
        """The difference relative to the table's value."""
        return self.value / self.best - 1

    @property
    def agrees(self) -> bool:
        return abs(self.value - self.best) <= self.error + self.best_error


def from_csv(text: str) -> list[Row]:
    """Reads the rows of the table."""
    return [_row(record) for record in csv.DictReader(io.StringIO(text))]


def checks_from_csv(text: str) -> list[Check]:
    return [
        Check(
            r["case"], r["quantity"], *(float(r[name]) for name in ("value", "error", "best", "best_error"))
        )
        for r in csv.DictReader(io.StringIO(text))
    ]


def load(folder: Path = PLACE) -> tuple[list[Row], list[Check]]:
    """Returns the table in a folder and its checks."""
    return (
        from_csv((folder / TABLE).read_text(encoding="utf-8")),
        checks_from_csv((folder / CHECKS).read_text(encoding="utf-8")),
    )


def digest() -> str:
    """Returns a hash of the table and of its checks."""
    contents = [(PLACE / name).read_bytes() for name in (TABLE, CHECKS)]
    return hashlib.sha256(b"".join(contents)).hexdigest()


def cases() -> list[Case]:
    """Returns the set-ups in the order of the table."""
    return [case for case in study.load(study.find(STUDY)).cases() if case.family != EMPTY]


def _row(record: dict[str, str]) -> Row:
    parameters = {name: float(record[f"{name}_m"]) for name in _LENGTHS if record[f"{name}_m"]}
    parameters |= {name: float(record[name]) for name in _ANGLES if record[name]}
    vectors = [np.array([float(record[f"{vector}_{axis}_m"]) for axis in "xyz"]) for vector in _VECTORS]
    values = {
        quantity: Value(*(float(record[f"{quantity}{suffix}_pF"]) for suffix in _PARTS))
        for quantity in QUANTITIES
    }
    return Row(record["case"], record["family"], parameters, Rectangle(*vectors), values)
