"""Figures of Experiment VIII: what insulators make of the change, and how far off the layer rule is."""

from __future__ import annotations

import plotly.graph_objects as go

from analysis.report.plot import Panel, axis, boxes, figure, log_axis, rows_axis, series_colour
from analysis.topics.insulators.records import Entry, by_family
from analysis.topics.insulators.set_ups import COVER, FILM, TARGET
from analysis.topics.insulators.stage import FORMULA, IGNORING

_PERCENT = 100.0
# Height (pixels) of a row of boxes, and of what is around the rows.
_ROW, _AROUND = 62, 140
_HOVER = "%{text}<br>%{x:.3g}, %{y:.3g}<extra></extra>"


def of_families(found: list[Entry]) -> Panel:
    """Plots the true change with the insulator over that without it, a box for each family, with all set-ups."""
    families = by_family(found)
    traces = [
        boxes([(family, entry.factor, entry.set_up.name) for entry in members], family, series_colour(index))
        for index, (family, members) in enumerate(families.items())
    ]
    x = log_axis("change with the insulator over that without it")
    return Panel(
        "what insulators make of the change",
        figure(traces, x, rows_axis(list(families)), height=_AROUND + _ROW * len(families), showlegend=False),
    )


def of_layers(found: list[Entry]) -> Panel:
    """Plots what covers and films add to the change over the shift of the layer rule relative to the hand's distance."""
    traces: list[object] = []
    for index, family in enumerate((COVER, FILM)):
        members = by_family(found).get(family, [])
        traces.append(
            go.Scatter(
                x=[entry.set_up.shift / entry.set_up.gap for entry in members],
                y=[_PERCENT * (entry.factor - 1) for entry in members],
                error_y={"array": [_PERCENT * entry.uncertainty for entry in members], "thickness": 1},
                text=[entry.set_up.name for entry in members],
                mode="markers",
                marker={"color": series_colour(index), "size": 6},
                name=family,
                hovertemplate=_HOVER,
            )
        )
    x = log_axis("thickness · (1 − 1/permittivity) over the distance of the hand")
    return Panel("what layers add to the change", figure(traces, x, axis("added to the change (%)")))


def of_rule(found: list[Entry]) -> Panel:
    """Plots the errors of the formula's change with the layer rule and without regard to the layer."""
    traces = []
    for index, method in enumerate((FORMULA, IGNORING)):
        points = [
            (entry.set_up.family, _PERCENT * entry.error(method), entry.set_up.name)
            for entry in found
            if method in entry.changes and entry.set_up.family in (COVER, FILM)
        ]
        name = "with the layer rule" if method == FORMULA else "without regard to the layer"
        traces.append(boxes(points, name, series_colour(index)))
    shown = figure(
        traces,
        axis("formula: error of the change (%)"),
        rows_axis([COVER, FILM]),
        height=320,
        boxmode="group",
    )
    return Panel("the layer rule", shown)


def of_targets(found: list[Entry]) -> Panel:
    """Plots the change by insulating targets over that by grounded ones, over their permittivity; the formula's estimates beside the truth."""
    members = by_family(found).get(TARGET, [])
    changes = {
        ("true change", "circle"): [entry.true.insulated.change.value for entry in members],
        ("formula's estimate", "x-thin-open"): [_estimate(entry) for entry in members],
    }
    traces: list[object] = [
        go.Scatter(
            x=[entry.set_up.permittivity for entry in members],
            y=[value / entry.true.without.change.value for value, entry in zip(values, members, strict=True)],
            text=[entry.set_up.name for entry in members],
            mode="markers",
            marker={"color": series_colour(index), "size": 7, "symbol": symbol},
            name=name,
            hovertemplate=_HOVER,
        )
        for index, ((name, symbol), values) in enumerate(changes.items())
    ]
    x = log_axis("relative permittivity of the target")
    return Panel("insulating targets", figure(traces, x, log_axis("change over that by a grounded target")))


def _estimate(entry: Entry) -> float:
    return entry.changes[FORMULA].value if FORMULA in entry.changes else float("nan")
