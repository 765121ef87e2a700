"""The nights of a study: one small JSON file for each, in `history/` beside the table, and the table of the last one.

A night's file: `time` (UTC), `table` (sha256 of table.csv), `rows`, `to_do` (cases that were to solve), `failed`, `seconds` (the
night's), `reference_seconds` (all solves in the table, whenever made), `worst` (largest |model error| by quantity, null
without rows; earlier nights know fewer quantities), and, where there is a night before, `moved`, `slower`, `new`, `gone` and `largest` of the difference to it.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path

from analysis.results import table
from analysis.results.commands import COMPARED_METHOD
from analysis.results.store import Document, read_json, write_json, write_text
from analysis.results.study_results import Failure
from analysis.results.table import TABLE
from analysis.topics.history import difference
from analysis.topics.history.difference import Difference, Line, RowName

FOLDER = "history"
_LAST_TABLE = "last_table.csv"


@dataclass(frozen=True)
class Night:
    """The result of a night: the number of cases to solve, the failures, and the duration (s)."""

    to_do: int
    failures: list[Failure]
    seconds: float


def add(folder: Path, night: Night) -> Difference | None:
    """Records a night of the results in a folder; returns the difference from the night before, None without one."""
    place = folder / FOLDER
    now = (folder / TABLE).read_text(encoding="utf-8")
    nights = load(folder)
    _finish(place, now, nights)
    lines = difference.read(folder / TABLE)
    found = None
    if (place / _LAST_TABLE).is_file():
        found = difference.between(difference.read(place / _LAST_TABLE), lines)
    time = datetime.now(timezone.utc)
    entry: Document = {
        "time": time.isoformat(timespec="seconds"),
        "table": _hash(now),
        **_figures(lines, night),
    }
    if found is not None:
        compared = difference.to_document(found)
        counts = {kind: len(compared[kind]) for kind in ("moved", "slower", "new", "gone")}
        entry |= {**counts, "largest": compared["largest"]}
    write_json(place / f"{time:%Y-%m-%dT%H-%M-%S.%fZ}.json", entry)
    _keep(place, now)
    return found


def load(folder: Path) -> list[Document]:
    """Returns the nights of a study, the earliest first."""
    read = (read_json(path) for path in sorted((folder / FOLDER).glob("*.json")))
    return [night for night in read if night is not None]


def _finish(place: Path, now: str, nights: list[Document]) -> None:
    """Completes a night that was killed between its last two files: its table becomes the last one."""
    if nights and nights[-1]["table"] == _hash(now):
        _keep(place, now)


def _keep(place: Path, table: str) -> None:
    last = place / _LAST_TABLE
    if not last.is_file() or last.read_text(encoding="utf-8") != table:
        write_text(last, table)


def _figures(lines: dict[RowName, Line], night: Night) -> Document:
    solves = {name[0]: line.reference_seconds for name, line in lines.items()}
    return {
        "rows": len(lines),
        "to_do": night.to_do,
        "failed": len(night.failures),
        "seconds": round(night.seconds, 3),
        "reference_seconds": round(sum(solves.values()), 3),
        "worst": {quantity: _worst(lines, quantity) for quantity in table.QUANTITIES},
    }


def _worst(lines: dict[RowName, Line], quantity: str) -> float | None:
    errors = (
        abs(table.relative_error(line.model[COMPARED_METHOD], line.reference.value))
        for name, line in lines.items()
        if name[-1] == quantity and COMPARED_METHOD in line.model
    )
    return max(errors, default=None)


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
