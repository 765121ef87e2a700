"""Compares two tables of results: which values moved, which got slower, which are new or gone.

A value of a reference has moved if its two intervals do not overlap, so that one of them must be wrong: of the field solver, of
boundary elements, and, where no method answered both times, of the best truth at hand. The model has no error
bars except rounding and what some of its methods state: a value has moved if it changed by more than that and 1e-9 of itself. Run times depend on the machine, too: what got
slower is reported, but does not count as drift.
"""

from __future__ import annotations

import csv
import math
from dataclasses import asdict, dataclass, field
from pathlib import Path

from analysis.results.answers import Estimate
from analysis.results.store import Document
from analysis.results.table import TABLE
from analysis.results.truth import BOUNDARY, FIELD
from geometries.common.errors import InputError

REFERENCE = "reference"
# The columns of the two methods; tables of earlier versions have neither.
_METHODS = {FIELD: "field", BOUNDARY: "boundary"}
# Relative change of the model's values that counts as moved: 1e5 times the rounding errors on any instruction set.
_MODEL_ROUNDING = 1e-9
# Slower means by this factor, and by these seconds, which a busy machine may add to a solve or to a microsecond.
_SLOWER_FACTOR, _SLOWER_SOLVE, _SLOWER_MODEL = 1.5, 5.0, 20e-6
_MOST_LINES = 20

_MODEL_ERROR = "_error_F"

RowName = tuple[str, str, str, str, str]
_NAME = ("case", "sensor", "object", "reading", "quantity")
# Tables of earlier versions have no readings.
_READING = "reading"


@dataclass(frozen=True)
class Line:
    """One row of a table: the best truth at hand with its error, the values of the methods that answered, the model's by method where it
    knows one (F), and the seconds of the field solver, or of boundary elements where they answer alone, and of the model.
    """

    family: str
    reference: Estimate
    reference_seconds: float
    model: dict[str, float]
    model_seconds: dict[str, float]
    by_method: dict[str, Estimate] = field(default_factory=dict)
    model_errors: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Change:
    """A value of one row. `who` is the reference or a method of the model; `over_errors` is the change relative to the
    allowed change."""

    name: RowName
    family: str
    who: str
    old: float
    new: float
    over_errors: float

    @property
    def relative(self) -> float:
        return (self.new - self.old) / abs(self.old) if self.old else math.copysign(math.inf, self.new)


@dataclass(frozen=True)
class Slower:
    """Run times (s) of one row's reference, or of a method of the model."""

    name: RowName
    family: str
    who: str
    old: float
    new: float


@dataclass(frozen=True)
class Difference:
    """`moved` with the largest first; `largest` is the largest change over its errors, moved or not; `rows` those in both."""

    rows: int
    moved: list[Change]
    slower: list[Slower]
    new: list[RowName]
    gone: list[RowName]
    largest: float

    @property
    def drifted(self) -> bool:
        return bool(self.moved)


def read(path: Path) -> dict[RowName, Line]:
    """Returns the rows of a table, or of the table in a folder of results; InputError when it cannot be used."""
    file = path / TABLE if path.is_dir() else path
    try:
        with file.open(encoding="utf-8", newline="") as opened:
            reader = csv.DictReader(opened)
            records = list(reader)
            columns = reader.fieldnames or []
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(str(file), "", f"cannot be read: {error}") from error
    needed = {*_NAME, "family", "reference_F", "reference_error_F", "reference_seconds"} - {_READING}
    # A table without rows has no columns but one.
    if lacking := sorted(needed - set(columns)) if records or columns != ["case"] else []:
        raise InputError(str(file), lacking[0], "is missing from the columns of this table")
    found = {}
    for number, record in enumerate(records, start=2):
        try:
            case, sensor, body, reading, quantity = (record.get(column) or "" for column in _NAME)
            found[case, sensor, body, reading, quantity] = _line(record)
        except (TypeError, ValueError) as error:
            raise InputError(str(file), f"line {number}", f"is not a row of a table: {error}") from error
    return found


def _line(record: dict[str, str]) -> Line:
    methods = [
        name[len("model_") : -len("_F")] for name in record if _is_model_value(name) and record[name] != ""
    ]
    return Line(
        record["family"],
        Estimate(float(record["reference_F"]), float(record["reference_error_F"])),
        float(record.get("field_seconds") or record["reference_seconds"]),
        {method: float(record[f"model_{method}_F"]) for method in methods},
        {method: float(record.get(f"model_{method}_seconds") or "nan") for method in methods},
        {
            method: Estimate(float(record[f"{column}_F"]), float(record[f"{column}_error_F"]))
            for method, column in _METHODS.items()
            if record.get(f"{column}_F")
        },
        {
            method: float(record[f"model_{method}{_MODEL_ERROR}"])
            for method in methods
            if record.get(f"model_{method}{_MODEL_ERROR}")
        },
    )


def _is_model_value(column: str) -> bool:
    return column.startswith("model_") and column.endswith("_F") and not column.endswith(_MODEL_ERROR)


def between(old: dict[RowName, Line], new: dict[RowName, Line]) -> Difference:
    """Returns what is different in `new`."""
    both = [name for name in new if name in old]
    changes = [change for name in both for change in _changes(name, old[name], new[name])]
    slower = [found for name in both for found in _slower(name, old[name], new[name])]
    return Difference(
        rows=len(both),
        moved=sorted((c for c in changes if not c.over_errors <= 1), key=lambda c: -c.over_errors),
        slower=sorted(slower, key=lambda found: found.old / found.new),
        new=[name for name in new if name not in old],
        gone=[name for name in old if name not in new],
        largest=max((change.over_errors for change in changes), default=0.0),
    )


def _changes(name: RowName, old: Line, new: Line) -> list[Change]:
    references = [
        (method, old.by_method[method], after)
        for method, after in new.by_method.items()
        if method in old.by_method
    ] or [(REFERENCE, old.reference, new.reference)]
    values = [
        (who, before.value, after.value, before.error + after.error) for who, before, after in references
    ]
    for method in (method for method in new.model if method in old.model):
        before, after = old.model[method], new.model[method]
        stated = old.model_errors.get(method, 0.0) + new.model_errors.get(method, 0.0)
        values.append(
            (f"model {method}", before, after, stated + _MODEL_ROUNDING * max(abs(before), abs(after)))
        )
    return [
        Change(name, new.family, who, before, after, _over(before, after, error))
        for who, before, after, error in values
    ]


def _over(before: float, after: float, error: float) -> float:
    """Returns |after − before| relative to the allowed change; 0 for equal values, also infinite ones, and infinity if one is finite."""
    if before == after or (math.isnan(before) and math.isnan(after)):
        return 0.0
    if not (math.isfinite(before) and math.isfinite(after)):
        return math.inf
    return abs(after - before) / error if error > 0 else math.inf


def _slower(name: RowName, old: Line, new: Line) -> list[Slower]:
    times = [(REFERENCE, old.reference_seconds, new.reference_seconds, _SLOWER_SOLVE)]
    for method in (method for method in new.model_seconds if method in old.model_seconds):
        seconds = old.model_seconds[method], new.model_seconds[method]
        times.append((f"model {method}", *seconds, _SLOWER_MODEL))
    return [
        Slower(name, new.family, who, before, after)
        for who, before, after, least in times
        if after > _SLOWER_FACTOR * before and after - before > least
    ]


def to_text(found: Difference) -> str:
    """Writes a difference for people: a line that sums up, then the largest of each kind."""
    lines = [
        f"{found.rows} rows in both: {len(found.moved)} values moved by more than their errors, {len(found.slower)} run times "
        f"got longer; {len(found.new)} rows are new, {len(found.gone)} are gone; the largest change is {found.largest:.2g} of "
        "what the errors allow"
    ]
    lines += _table(
        "moved",
        [
            [
                *_words(c.name, c.family),
                c.who,
                f"{c.old:.7g} F",
                f"{c.new:.7g} F",
                f"{c.relative:+.2e}",
                f"{c.over_errors:.3g}",
            ]
            for c in found.moved
        ],
        ["family", "case", "what", "whose", "old", "new", "relative", "over errors"],
    )
    lines += _table(
        "slower",
        [
            [
                *_words(s.name, s.family),
                s.who,
                f"{s.old:.3g} s",
                f"{s.new:.3g} s",
                f"{s.new / s.old:.1f} times",
            ]
            for s in found.slower
        ],
        ["family", "case", "what", "whose", "old", "new", "longer"],
    )
    for title, names in (("new", found.new), ("gone", found.gone)):
        lines += _table(title, [[name[0], *_words(name, "")[2:]] for name in names], ["case", "what"])
    return "\n".join(lines) + "\n"


def _words(name: RowName, family: str) -> list[str]:
    case, sensor, body, reading, quantity = name
    return [family, case, " ".join(part for part in (quantity, sensor, body, reading) if part)]


def _table(title: str, rows: list[list[str]], header: list[str]) -> list[str]:
    if not rows:
        return []
    shown = [header, *rows[:_MOST_LINES]]
    widths = [max(len(row[column]) for row in shown) for column in range(len(header))]
    lines = [
        "  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in shown
    ]
    more = [f"  … and {len(rows) - _MOST_LINES} more"] if len(rows) > _MOST_LINES else []
    return ["", title, *lines, *more]


def to_document(found: Difference) -> Document:
    """Writes a difference for programs: everything, in farads and seconds. Infinity becomes null, which JSON can express."""
    document: Document = {"drifted": found.drifted, **asdict(found)}
    for change in document["moved"]:
        change["over_errors"] = _finite(change["over_errors"])
        change["old"], change["new"] = _finite(change["old"]), _finite(change["new"])
    document["largest"] = _finite(found.largest)
    return document


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
