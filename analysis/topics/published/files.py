"""Writes and reads the table and its checks as CSV files."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analysis.results.set_up import Rectangle
from analysis.topics.published.rows import QUANTITIES, Row, Value

TABLE, CHECKS, PAGE = "reference_table.csv", "checks.csv", "TABLE.md"

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


def to_csv(found: list[Row]) -> str:
    """Writes a line for each set-up; metres, degrees, picofarad."""
    return _text([_record(row) for row in found])


def from_csv(text: str) -> list[Row]:
    """Reads the rows of the table."""
    return [_row(record) for record in csv.DictReader(io.StringIO(text))]


def checks_to_csv(checks: list[Check]) -> str:
    return _text(
        [{name: f"{v:.8g}" if isinstance(v, float) else v for name, v in vars(c).items()} for c in checks]
    )


def checks_from_csv(text: str) -> list[Check]:
    return [
        Check(
            r["case"], r["quantity"], *(float(r[name]) for name in ("value", "error", "best", "best_error"))
        )
        for r in csv.DictReader(io.StringIO(text))
    ]


def load(folder: Path) -> tuple[list[Row], list[Check]]:
    """Returns the table in a folder and its checks."""
    return (
        from_csv((folder / TABLE).read_text(encoding="utf-8")),
        checks_from_csv((folder / CHECKS).read_text(encoding="utf-8")),
    )


def _text(records: list[dict[str, object]]) -> str:
    text = io.StringIO()
    writer = csv.DictWriter(text, list(records[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(records)
    return text.getvalue()


def _record(row: Row) -> dict[str, object]:
    record: dict[str, object] = {"case": row.case, "family": row.family}
    for name in _LENGTHS:
        record[f"{name}_m"] = f"{row.parameters[name]:g}" if name in row.parameters else ""
    for name in _ANGLES:
        record[name] = f"{row.parameters[name]:g}" if name in row.parameters else ""
    for vector in _VECTORS:
        # The sum turns -0.0 into 0.0.
        numbers = np.round(getattr(row.target, vector), 12) + 0.0
        record |= {f"{vector}_{axis}_m": f"{number:.12g}" for axis, number in zip("xyz", numbers)}
    for quantity in QUANTITIES:
        value = row.values[quantity]
        record |= {f"{quantity}{suffix}_pF": f"{getattr(value, part):.8g}" for suffix, part in _PARTS.items()}
    return record


def _row(record: dict[str, str]) -> Row:
    parameters = {name: float(record[f"{name}_m"]) for name in _LENGTHS if record[f"{name}_m"]}
    parameters |= {name: float(record[name]) for name in _ANGLES if record[name]}
    vectors = [np.array([float(record[f"{vector}_{axis}_m"]) for axis in "xyz"]) for vector in _VECTORS]
    values = {
        quantity: Value(*(float(record[f"{quantity}{suffix}_pF"]) for suffix in _PARTS))
        for quantity in QUANTITIES
    }
    return Row(record["case"], record["family"], parameters, Rectangle(*vectors), values)
