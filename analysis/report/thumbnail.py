"""Thumbnails of figures, as SVG: the pictures on the cards of a report."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from analysis.report.drawing import HEIGHT, MARGIN, WIDTH, fitted, svg
from analysis.report.plot import GRID, SENSOR_COLOUR

Array = NDArray[np.float64]
Trace = dict[str, Any]

_DRAWN = ("scatter", "bar")
_RADIUS = 2.2
_MARKS = 300
"""Marks of one trace at most; of more, every second, third … is drawn."""


def thumbnail(data: list[Trace], layout: dict[str, Any], label: str) -> Markup:
    """Draws the points, lines and bars of a figure of plotly, given as its JSON, without axes; empty if it has none of them."""
    drawn = [(trace, points) for trace, points in _all_points(data, layout) if len(points)]
    if not drawn:
        return Markup("")
    whole = np.concatenate([points for _, points in drawn])
    placed = np.split(
        fitted(whole * np.array([1.0, -1.0]), keep_aspect=False),
        np.cumsum([len(points) for _, points in drawn]),
    )
    line = Markup('<path class="axes" d="M{0},{0}V{1}H{2}" fill="none" stroke="{3}" stroke-width="1.5"/>')
    parts = [line.format(MARGIN / 2, HEIGHT - MARGIN / 2, WIDTH - MARGIN / 2, GRID)]
    for (trace, _), own in zip(drawn, placed):
        parts += _bars(trace, own) if trace.get("type") == "bar" else _marks(trace, own)
    return svg(parts, label)


def _all_points(data: list[Trace], layout: dict[str, Any]) -> list[tuple[Trace, Array]]:
    """Returns the points (n, 2) of each trace; a bar has two, its ends. Bars stand on those before them, as in a stacked figure."""
    found = []
    above: dict[float, float] = {}
    below: dict[float, float] = {}
    for trace in data:
        if trace.get("type", "scatter") not in _DRAWN:
            continue
        points = _points(trace, layout)
        if trace.get("type") == "bar":
            ends = []
            for x, height in points:
                stack = above if height >= 0 else below
                start = stack.get(x, 0.0)
                stack[x] = start + height
                ends += [(x, start), (x, start + height)]
            points = np.array(ends).reshape(-1, 2)
        found.append((trace, points))
    return found


def _points(trace: Trace, layout: dict[str, Any]) -> Array:
    """Returns the finite points (n, 2) of a trace on the scales of its axes; names, as of bars, are numbered."""
    columns = []
    for name in ("x", "y"):
        values = trace.get(name) or []
        if any(isinstance(value, str) for value in values):
            values = list(range(len(values)))
        numbers = np.array([math.nan if value is None else float(value) for value in values])
        if layout.get(f"{name}axis", {}).get("type") == "log":
            numbers = np.log10(np.where(numbers > 0, numbers, math.nan))
        columns.append(numbers)
    if len(columns[0]) != len(columns[1]):
        return np.empty((0, 2))
    both = np.stack(columns, axis=-1)
    return np.asarray(both[np.isfinite(both).all(axis=1)])


def _colour(trace: Trace, part: str) -> str:
    colour = trace.get(part, {}).get("color")
    return colour if isinstance(colour, str) else SENSOR_COLOUR


def _marks(trace: Trace, points: Array) -> list[Markup]:
    parts = []
    if "lines" in trace.get("mode", "lines"):
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        line = Markup('<polyline points="{}" fill="none" stroke="{}" stroke-width="1.5"/>')
        parts.append(line.format(path, _colour(trace, "line")))
    if "markers" in trace.get("mode", ""):
        step = math.ceil(len(points) / _MARKS)
        mark = Markup('<circle cx="{}" cy="{}" r="{}" fill="{}"/>')
        parts += [
            mark.format(f"{x:.1f}", f"{y:.1f}", _RADIUS, _colour(trace, "marker")) for x, y in points[::step]
        ]
    return parts


def _bars(trace: Trace, ends: Array) -> list[Markup]:
    width = 1.4 * (WIDTH - 2 * MARGIN) / len(ends)
    bar = Markup('<rect x="{}" y="{}" width="{}" height="{}" fill="{}"/>')
    return [
        bar.format(
            f"{x - width / 2:.1f}",
            f"{min(y, end):.1f}",
            f"{width:.1f}",
            f"{abs(end - y):.1f}",
            _colour(trace, "marker"),
        )
        for (x, y), (_, end) in zip(ends[::2], ends[1::2])
    ]
