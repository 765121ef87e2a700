"""`history.html`: the nights of a study, as curves and as a table."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import plotly.graph_objects as go
from markupsafe import Markup

from analysis.pipeline import keys
from analysis.report import page
from analysis.report.page import is_current
from analysis.report.plot import Panel, axis, figure, guide, power_axis, series_colour
from analysis.results import study_results as results
from analysis.results.store import Document
from analysis.results.table import QUANTITIES
from analysis.results.units import percent
from analysis.topics.history import nights as history

HISTORY = "history.html"
# Ordinate of nights without any change: a logarithmic axis has no zero.
_LEAST = 1e-6


def make(folder: Path) -> Path:
    """Writes the page of the nights in a folder, unless it is up to date."""
    nights = history.load(folder)
    target = folder / HISTORY
    inputs = keys.page_inputs(nights)
    if not is_current(target, inputs):
        page.provide_script(folder)
        page.write(target, _page(results.title(folder), nights, inputs))
    return target


def _page(title: str, nights: list[Document], inputs: str) -> str:
    return page.document(
        f"Nights: {title}",
        inputs,
        [
            page.header(
                f"Nights: {title}",
                page.finding(finding(nights)),
                page.paragraph(
                    "Every night is compared with the one before. A value has moved when it changed by more than its errors: the "
                    "reference's by more than the sum of its two error bars, the model's by more than rounding."
                ),
                page.paragraph(page.link(page.REPORT, "What the last night found")),
            ),
            page.figures(_panels(nights)),
            page.section("Every night", _table(nights)),
        ],
        page.SCRIPT,
    )


def finding(nights: list[Document]) -> str:
    """Returns one sentence on all nights, one on the last that moved something."""
    if not nights:
        return "No night is recorded yet."
    compared = [night for night in nights if "moved" in night]
    moved = [night for night in compared if night["moved"]]
    failed = sum(night["failed"] > 0 for night in nights)
    sentence = f"{len(nights)} nights since {_day(nights[0])}; {failed} of them with failed cases."
    if not moved:
        return f"{sentence} Nothing has moved by more than its errors in {len(compared)} comparisons."
    return (
        f"{sentence} Something moved by more than its errors in {len(moved)} of {len(compared)} comparisons, the last time on "
        f"{_day(moved[-1])}: {moved[-1]['moved']} values."
    )


def _day(night: Document) -> str:
    return str(night["time"])[:16].replace("T", " ")


def _panels(nights: list[Document]) -> list[Panel]:
    compared = [night for night in nights if "moved" in night]
    times = axis("night (UTC)", type="date")
    counts = [_curve(compared, name, index) for index, name in enumerate(("moved", "slower", "new", "gone"))]
    counts.append(_curve(nights, "failed", 4))
    worst = [
        _line(quantity, nights, [night["worst"].get(quantity) for night in nights], index)
        for index, quantity in enumerate(QUANTITIES)
    ]
    largest = [night["largest"] for night in compared]
    changes = _line(
        "largest change",
        compared,
        [max(value, _LEAST) if value is not None else None for value in largest],
        0,
    )
    ends = [night["time"] for night in compared[:1] + compared[-1:]]
    allowed = guide("more has moved", ends, [1] * len(ends))
    seconds = [
        _line("solves in the table", nights, [night["reference_seconds"] for night in nights], 0),
        _line("the night itself", nights, [night["seconds"] for night in nights], 1),
    ]
    return [
        Panel(
            f"largest change of a value over its errors{_at_most(compared, largest)}",
            figure([changes, allowed], times, power_axis("change over errors")),
        ),
        Panel(_counted(compared), figure(counts, times, axis("number", rangemode="tozero"))),
        Panel(
            f"worst model error{_at_most(nights, [night['worst'][QUANTITIES[0]] for night in nights], QUANTITIES[0])}",
            figure(worst, times, axis("|model error|", tickformat=".0%", rangemode="tozero")),
        ),
        Panel(
            f"time{_at_most(nights, [night['seconds'] for night in nights], 'seconds of a night')}",
            figure(seconds, times, power_axis("seconds")),
        ),
    ]


def _at_most(nights: list[Document], values: list[Any], name: str = "") -> str:
    """Writes when a value was greatest, as the end of a caption."""
    known = [(value, _day(night)) for value, night in zip(values, nights) if value is not None]
    if not known:
        return ""
    value, day = max(known)
    return f": at most {value:.3g}{' ' if name else ''}{name}, on {day}"


def _counted(compared: list[Document]) -> str:
    names = ("moved", "slower", "new", "gone")
    counts = ", ".join(f"{sum(night[name] for night in compared)} {name}" for name in names)
    return f"how many values and rows; over all nights {counts}"


def _curve(nights: list[Document], name: str, index: int) -> go.Scatter:
    return _line(name, nights, [night[name] for night in nights], index)


def _line(name: str, nights: list[Document], values: list[Any], index: int) -> go.Scatter:
    return go.Scatter(
        x=[night["time"] for night in nights],
        y=values,
        mode="lines+markers",
        name=name,
        line={"color": series_colour(index)},
        marker={"size": 6},
    )


def _table(nights: list[Document]) -> Markup:
    header = [
        "night (UTC)",
        "solved",
        "failed",
        "moved",
        "slower",
        "new",
        "gone",
        "largest change",
        "night (s)",
    ]
    header += [f"worst {quantity}" for quantity in QUANTITIES]
    rows = [
        [
            _day(night),
            *(str(night[name]) for name in ("to_do", "failed")),
            *(str(night.get(name, "")) for name in ("moved", "slower", "new", "gone")),
            _number(night["largest"]) if "largest" in night else "",
            f"{night['seconds']:.1f}",
            *(_percent(night["worst"].get(quantity)) for quantity in QUANTITIES),
        ]
        for night in reversed(nights)
    ]
    strong = frozenset(index for index, night in enumerate(reversed(nights)) if night.get("moved"))
    return page.table(header, rows, strong=strong)


def _number(value: float | None) -> str:
    return "∞" if value is None else f"{value:.2g}"


def _percent(value: float | None) -> str:
    return "" if value is None else percent(value)
