"""Figures of the model's error on machines: its change over the true one, and the parts of the error."""

from __future__ import annotations

import math

import plotly.graph_objects as go

from analysis.report.plot import (
    Panel,
    axis,
    boxes,
    family_marker,
    figure,
    power_axis,
    rows_axis,
    series_colour,
)
from analysis.topics.machines.parts import ALL_PARTS
from analysis.topics.machines.records import Entry
from analysis.topics.machines.set_ups import FAMILIES
from analysis.topics.machines.stage import METHODS

# Height (pixels) of a family's boxes, of a part's, and of what is around them.
_FAMILY, _PART, _AROUND = 82, 36, 150
_TICKS = (-100, -10, -1, 0, 1, 10, 100, 1000)


def of_methods(found: list[Entry]) -> Panel:
    """Plots each method's change over the true one, boxes for each family, with all points."""
    traces = [_boxes(found, method, series_colour(index)) for index, method in enumerate(METHODS)]
    return Panel(
        "the model's change over the true one",
        figure(
            traces,
            power_axis("the model's change over the true one"),
            rows_axis(list(FAMILIES)),
            height=_AROUND + _FAMILY * len(FAMILIES),
            boxmode="group",
        ),
    )


def of_parts(found: list[Entry]) -> Panel:
    """Plots every part over the true change, a point for each set-up that has it."""
    there = [name for name in ALL_PARTS if any(entry.parts()[name] for entry in found)]
    traces = [_points(found, family, there) for family in FAMILIES]
    # Parts of either sign over five decades: linear up to the change itself, then logarithmic.
    x = axis(
        "part of the error over the true change",
        tickvals=[_place(value) for value in _TICKS],
        ticktext=[f"{value:g}" for value in _TICKS],
    )
    return Panel(
        "the parts of the error",
        figure(traces, x, rows_axis(there), height=_AROUND + _PART * len(there)),
    )


def _place(value: float) -> float:
    """Returns where a part is drawn: as itself up to 1, beyond that by its logarithm."""
    return value if abs(value) <= 1 else math.copysign(1 + math.log10(abs(value)), value)


def _points(found: list[Entry], family: str, there: list[str]) -> go.Scatter:
    points = [
        (name, value, entry.set_up.name)
        for entry in found
        if entry.set_up.family == family
        for name, value in entry.parts().items()
        if name in there and value != 0
    ]
    return go.Scatter(
        x=[_place(value) for _, value, _ in points],
        y=[name for name, _, _ in points],
        text=[f"{value:+.3g}<br>{name}" for _, value, name in points],
        mode="markers",
        marker=family_marker(family, list(FAMILIES), size=6, opacity=0.45),
        name=family,
        hovertemplate="%{text}<extra>%{y}</extra>",
    )


def _boxes(found: list[Entry], method: str, colour: str) -> go.Box:
    answering = [entry for entry in found if method in entry.methods]
    points = [(entry.set_up.family, entry.ratio(method), entry.set_up.name) for entry in answering]
    return boxes(points, method, colour)
