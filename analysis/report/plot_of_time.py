"""Run time against error: the model's methods and the reference's meshes on one plot with logarithmic axes."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
import plotly.graph_objects as go

from analysis.report.plot import Panel, Plot, figure, power_axis, series_colour
from analysis.results.commands import COMPARED_METHOD
from analysis.results.table import MUTUAL, Row
from analysis.results.units import duration, percent

_SPLIT = re.compile(r"split:\d+")


@dataclass(frozen=True)
class Point:
    """Medians over the cases: seconds and relative error."""

    label: str
    seconds: float
    error: float


def split_methods(rows: list[Row]) -> list[str]:
    """Returns the thesis' methods among those evaluated, from coarse to fine."""
    methods = {method for row in rows for method in row.model if _SPLIT.fullmatch(method)}
    return sorted(methods, key=lambda method: int(method.removeprefix("split:")))


def integration_errors(rows: list[Row]) -> list[Point]:
    """Returns |split − exact|/exact: the error of dividing into small triangles, with the same formula."""
    return [
        _point(method, known, [abs(row.model[method] / row.model[COMPARED_METHOD] - 1) for row in known])
        for method in split_methods(rows)
        if (known := _known(rows, method))
    ]


def total_errors(rows: list[Row], methods: list[str]) -> list[Point]:
    """Returns |method − reference|/reference."""
    return [
        _point(method, known, [abs(row.model[method] / row.reference.value - 1) for row in known])
        for method in methods
        if (known := _known(rows, method))
    ]


def _known(rows: list[Row], method: str) -> list[Row]:
    """Returns the rows that a method has a value of: one may refuse a case."""
    return [row for row in rows if method in row.model]


def level_errors(rows: list[Row]) -> list[Point]:
    """Returns |level − best|/best of the reference's meshes from coarse to fine, with the seconds of each mesh; a value of 0, as behind a
    grounded plate, has no relative error."""
    solved = [
        (row, row.case.reference)
        for row in rows
        if row.case.reference is not None and row.reference.value != 0
    ]
    points = []
    for depth in range(max((len(answer.levels) for _, answer in solved), default=0)):
        errors, seconds = [], []
        for row, answer in solved:
            if depth < len(answer.levels):
                level, names = answer.levels[depth], answer.conductors
                value = -level.maxwell[names.index(row.sensor), names.index(row.object)]
                errors.append(abs(value / row.reference.value - 1))
                seconds.append(level.seconds)
        points.append(Point(f"level {depth + 1}", float(np.median(seconds)), float(np.median(errors))))
    return points


def time_against_error(rows: list[Row]) -> Plot:
    """Plots run time against all of these errors for `mutual`."""
    mutual = [row for row in rows if row.quantity == MUTUAL]
    integration, splits = integration_errors(mutual), total_errors(mutual, split_methods(mutual))
    (exact,) = total_errors(mutual, [COMPARED_METHOD])
    levels = level_errors(mutual)
    traces = [
        _series(
            "split:N, integration error |split − exact|/exact", integration, 0, "circle", "lines+markers+text"
        ),
        _series("split:N, total error |split − reference|/reference", splits, 1, "square", "lines+markers"),
        _series("exact, total error |exact − reference|/reference", [exact], 2, "star", "markers", size=16),
        _series("field solver, |mesh − best|/best", levels, 3, "diamond", "lines+markers+text"),
    ]
    x, y = power_axis("seconds for one case"), power_axis("relative error in mutual")
    return Plot(
        "Run time against error (mutual)",
        _finding(exact, integration, splits, levels),
        [Panel("medians over the cases", figure(traces, x, y, height=520))],
        "The thesis' method split:N divides each triangle into 4^N. Model times are the smallest of many evaluations of a "
        "loaded scene, solver times those of one mesh.",
    )


def _finding(exact: Point, integration: list[Point], splits: list[Point], levels: list[Point]) -> str:
    sentence = f"The exact model takes {duration(exact.seconds)} and is {percent(exact.error)} off, the median of all cases"
    if splits:
        factor, finest = splits[-1].seconds / exact.seconds, splits[-1].label
        sentence += (
            f"; {finest} takes {factor:.0f} times as long, agrees with it to {integration[-1].error:.1g} and is"
            f" {percent(splits[-1].error)} off all the same, so the formula is wrong and not its integration"
        )
    if levels:
        sentence += f"; the field solver's coarsest mesh is {percent(levels[0].error)} off after {duration(levels[0].seconds)}"
    return sentence + "."


def _point(label: str, rows: list[Row], errors: list[float]) -> Point:
    return Point(
        label, float(np.median([row.model_seconds[label] for row in rows])), float(np.median(errors))
    )


def _series(name: str, points: list[Point], index: int, symbol: str, mode: str, size: int = 9) -> go.Scatter:
    # A logarithmic axis has no zero: no point is drawn where split and exact agree to the last bit.
    shown = [point for point in points if point.error > 0]
    return go.Scatter(
        x=[point.seconds for point in shown],
        y=[point.error for point in shown],
        mode=mode,
        text=[point.label.removeprefix("split:") for point in shown],
        textposition="top right",
        cliponaxis=False,
        marker={"color": series_colour(index), "symbol": symbol, "size": size},
        line={"color": series_colour(index)},
        name=name,
        hovertemplate=name + "<br>%{text}: %{x:.3g} s, %{y:.3g}<extra></extra>",
    )
