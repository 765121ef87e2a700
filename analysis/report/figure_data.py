"""The numbers of a figure as CSV, as plotly draws them."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator
from typing import Any

Trace = dict[str, Any]
_COLUMNS = ("value", "error", "error below", "note", "set-up")
_IN_SPACE = ("mesh3d", "scatter3d", "cone", "surface")
_BREAK = re.compile(r"<br>")


def has_table(traces: list[Trace]) -> bool:
    """Tells whether a figure is of numbers along two axes, and not of bodies in space."""
    return not any(trace.get("type") in _IN_SPACE for trace in traces)


def to_csv(traces: list[Trace], layout: dict[str, Any]) -> str:
    """Returns a line for each point of a figure: its series, where it is along both axes, which give the columns their names, and of its value, its
    error, its note and its set-up those that any point has."""
    rows = [row for trace in traces for row in _rows(trace)]
    used = [column for column in range(3, 3 + len(_COLUMNS)) if any(row[column] is not None for row in rows)]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    titles = [layout.get(axis, {}).get("title", {}).get("text") or axis[0] for axis in ("xaxis", "yaxis")]
    writer.writerow(["series", *titles, *(_COLUMNS[column - 3] for column in used)])
    writer.writerows([*row[:3], *(row[column] for column in used)] for row in rows)
    return text.getvalue()


def _rows(trace: Trace) -> Iterator[list[Any]]:
    name, across, upwards = trace.get("name", ""), trace.get("x") or [], trace.get("y") or []
    if "z" in trace:
        for y, values, texts, cases in zip(
            upwards, trace["z"], *(trace.get(key) or [[]] * len(upwards) for key in ("text", "customdata"))
        ):
            for column, (x, value) in enumerate(zip(across, values)):
                yield [name, x, y, value, None, None, _note(texts, column), _at(cases, column)]
        return
    bars = trace.get("error_y") or trace.get("error_x") or {}
    for index, (x, y) in enumerate(zip(across, upwards)):
        errors = (_at(bars.get(key), index) for key in ("array", "arrayminus"))
        note = _note(trace.get("text") or trace.get("hovertext"), index)
        yield [name, x, y, None, *errors, note, _at(trace.get("customdata"), index)]


def _at(values: Any, index: int) -> Any:
    return values[index] if isinstance(values, list) and index < len(values) else None


def _note(texts: Any, index: int) -> str | None:
    text = _at(texts, index)
    return _BREAK.sub("; ", text) if text else None
