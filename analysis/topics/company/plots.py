"""Figures of Experiment VII: every factor of the change, and the model's change over the true one."""

from __future__ import annotations

import plotly.graph_objects as go

from analysis.report.plot import INK, Panel, axis, figure, log_axis, series_colour
from analysis.topics.company.factors import Entry, Factor, of_model as factor_of_model
from analysis.topics.company.set_ups import MACHINES, TO_GROUND

# Height (pixels) of a row of points and of what is around them.
_ROW, _AROUND = 34, 150


def of_factors(found: list[Factor]) -> Panel:
    """Plots each factor in a row: one point for every pair of set-ups, and a bar at the median."""
    names = [factor.what for factor in found]
    traces: list[object] = []
    for factor in found:
        traces.append(_points(factor, factor.what, series_colour(0), "pairs of set-ups", factor is found[0]))
    traces.append(_medians([factor.median for factor in found], names))
    x = log_axis("change over the change without it", showgrid=True)
    y = axis("", type="category", categoryarray=names[::-1], categoryorder="array")
    return Panel(
        "what the company and the hand's connection make of the change",
        figure(traces, x, y, height=_AROUND + _ROW * len(names)),
    )


def of_model(found: list[Entry]) -> Panel:
    """Plots the model's change over the true one, a row for each machine and a colour for each connection of the hand."""
    traces: list[object] = []
    for index, ground in enumerate(TO_GROUND):
        shown = True
        for machine in MACHINES:
            factor = factor_of_model(found, machine, ground)
            if factor.ratios:
                traces.append(_points(factor, machine, series_colour(index), f"hand: {ground}", shown))
                shown = False
    x = log_axis("the model's change over the true one")
    y = axis("", type="category", categoryarray=list(MACHINES)[::-1], categoryorder="array")
    return Panel("the model", figure(traces, x, y, height=_AROUND + 2 * _ROW * len(MACHINES)))


def _points(factor: Factor, row: str, colour: str, name: str, shown: bool) -> go.Scatter:
    return go.Scatter(
        x=[ratio.value for ratio in factor.ratios],
        y=[row] * len(factor.ratios),
        text=[ratio.id for ratio in factor.ratios],
        mode="markers",
        marker={"color": colour, "size": 7, "opacity": 0.45},
        name=name,
        legendgroup=name,
        showlegend=shown,
        hovertemplate="%{x:.4g}<br>set-up %{text}<extra>" + factor.what + "</extra>",
    )


def _medians(values: list[float], names: list[str]) -> go.Scatter:
    return go.Scatter(
        x=values,
        y=names,
        mode="markers",
        marker={"color": INK, "symbol": "line-ns-open", "size": 20, "line": {"width": 3}},
        name="median",
        hovertemplate="median %{x:.4g}<extra>%{y}</extra>",
    )
