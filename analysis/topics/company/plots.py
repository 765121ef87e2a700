"""Figures of Experiment VII: every factor of the change, and the model's change over the true one."""

from __future__ import annotations

import plotly.graph_objects as go

from analysis.report.plot import INK, Panel, boxes, figure, log_axis, power_axis, rows_axis, series_colour
from analysis.topics.company.factors import (
    PARTS,
    Entry,
    Factor,
    factors,
    of_model as factor_of_model,
    of_part,
)
from analysis.topics.company.set_ups import MACHINES, TO_GROUND
from geometries.studies.families import FLOATING

# Height (pixels) of a row of points, of a row of boxes, and of what is around them.
_ROW, _BOXES, _AROUND = 34, 82, 150
_CONNECTED = tuple(ground for ground in TO_GROUND if ground != FLOATING)


def of_factors(found: list[Entry]) -> Panel:
    """Plots each factor in a row: a point for every pair of set-ups, and a bar at the median. Parts of machines have two colours,
    because they act otherwise on a floating hand."""
    made = factors(found)
    names = [factor.what for factor in made]
    split = {
        "hand grounded or through a capacitance": [of_part(found, part, _CONNECTED) for part in PARTS],
        "hand floating": [of_part(found, part, (FLOATING,)) for part in PARTS],
        "hand, against the grounded one": [factor for factor in made if factor.what not in PARTS],
    }
    traces: list[object] = [
        _points(name, factors_of_colour, series_colour(index))
        for index, (name, factors_of_colour) in enumerate(split.items())
    ]
    traces.append(_medians(made))
    x = log_axis("change over the change without it")
    return Panel(
        "what the company and the hand's connection make of the change",
        figure(traces, x, rows_axis(names), height=_AROUND + _ROW * len(names)),
    )


def of_model(found: list[Entry]) -> Panel:
    """Plots the model's change over the true one, boxes for each machine and each connection of the hand, with all points."""
    traces = [_boxes(found, ground, series_colour(index)) for index, ground in enumerate(TO_GROUND)]
    x = power_axis("the model's change over the true one")
    height = _AROUND + _BOXES * len(MACHINES)
    return Panel(
        "the model's change over the true one",
        figure(traces, x, rows_axis(list(MACHINES)), height=height, boxmode="group"),
    )


def _boxes(found: list[Entry], ground: str, colour: str) -> go.Box:
    made = {machine: factor_of_model(found, machine, ground) for machine in MACHINES}
    points = [(machine, ratio.value, ratio.id) for machine, factor in made.items() for ratio in factor.ratios]
    return boxes(points, f"hand: {ground}", colour, "set-up ")


def _points(name: str, made: list[Factor], colour: str) -> go.Scatter:
    points = [(factor.what, ratio) for factor in made for ratio in factor.ratios]
    return go.Scatter(
        x=[ratio.value for _, ratio in points],
        y=[what for what, _ in points],
        text=[ratio.id for _, ratio in points],
        mode="markers",
        marker={"color": colour, "size": 7, "opacity": 0.45},
        name=name,
        hovertemplate="%{x:.4g}<br>set-up %{text}<extra>%{y}</extra>",
    )


def _medians(made: list[Factor]) -> go.Scatter:
    return go.Scatter(
        x=[factor.median for factor in made],
        y=[factor.what for factor in made],
        mode="markers",
        marker={"color": INK, "symbol": "line-ns-open", "size": 20, "line": {"width": 3}},
        name="median",
        hovertemplate="median %{x:.4g}<extra>%{y}</extra>",
    )
