"""Experiment VII by two methods: the readings by boundary elements beside those by the field solver."""

from __future__ import annotations

import plotly.graph_objects as go
from markupsafe import Markup

from analysis.report import page
from analysis.report.plot import Panel, axis, figure, series_colour
from analysis.results.answers import Estimate
from analysis.results.units import percent, picofarads, signed_percent
from analysis.topics.company.set_ups import SetUp
from analysis.topics.field_solver import QUANTITIES, Comparison as AnyComparison

Comparison = AnyComparison[SetUp]
ABSENT = "None of these set-ups has a reading by the field solver."
_PERCENT = 100.0
# Distance between the points of a set-up, that of two set-ups being 1; the legend lies above, because the set-ups' names are below.
_ASIDE, _LEGEND = 0.2, {"orientation": "h", "y": 1.02, "yanchor": "bottom", "x": 0}
_WHAT = (
    "Error bars: the sum of the errors that both methods state; where they contain zero, the methods agree. The field solver's are estimates from two "
    "meshes, at least twice what the second one changes, or from three, extrapolated. Its readings are kept with the project; "
    "python3 -m analysis measure field-check company makes them in forty minutes of one core."
)


def parts(found: list[Comparison]) -> list[Markup]:
    """Returns the finding, the figure and the numbers."""
    if not found:
        return [page.paragraph(ABSENT)]
    header = ["set-up", "in company of", "hand", "quantity", "field solver (pF)", "boundary elements (pF)"]
    return [
        page.finding(finding(found)),
        page.figures([_differences(found)]),
        page.soft(_WHAT),
        page.folded(
            "Show the comparison",
            page.table([*header, "difference", "errors", "difference/errors"], _rows(found), text_columns=4),
        ),
    ]


def finding(found: list[Comparison]) -> str:
    """Tells how many values agree, and the largest difference relative to the errors, for each quantity."""
    agreeing = sum(each.over_errors <= 1 for each in found)
    set_ups = len({each.set_up.id for each in found})
    phrases = []
    for quantity in QUANTITIES:
        of_quantity = [each for each in found if each.quantity == quantity]
        worst = max(each.over_errors for each in of_quantity)
        farthest = max((each.difference for each in of_quantity), key=abs)
        phrases.append(f"{quantity} {worst:.2f} of the errors and {signed_percent(farthest)} of the value")
    sentence = (
        f"In {set_ups} set-ups that the field solver computes, too, {agreeing} of {len(found)} values agree within the errors that both "
        f"methods state. The largest differences, boundary elements less field solver, are: {'; '.join(phrases)}."
    )
    apart = [each for each in found if each.over_errors > 1]
    if not apart:
        return sentence
    told = ", ".join(f"{each.quantity} of set-up {each.set_up.id} ({each.over_errors:.2f})" for each in apart)
    return f"{sentence} Beyond their errors: {told}."


def _differences(found: list[Comparison]) -> Panel:
    names = list(dict.fromkeys(_name(each) for each in found))
    traces: list[object] = []
    for index, quantity in enumerate(QUANTITIES):
        members = [each for each in found if each.quantity == quantity]
        traces.append(
            go.Scatter(
                x=[names.index(_name(each)) + _ASIDE * (index - 1) for each in members],
                y=[_PERCENT * each.difference for each in members],
                error_y={"array": [_PERCENT * each.allowed for each in members], "thickness": 1.5},
                mode="markers",
                marker={"color": series_colour(index), "size": 7},
                text=[each.set_up.id for each in members],
                name=quantity,
                hovertemplate="%{y:+.3f} %<br>set-up %{text}<extra>" + quantity + "</extra>",
            )
        )
    x = axis("", tickvals=list(range(len(names))), ticktext=names, tickangle=-60)
    shown = figure(traces, x, axis("boundary elements less field solver (%)"), height=560, legend=_LEGEND)
    return Panel("both methods, set-up by set-up: company, and the hand's connection", shown)


def _name(comparison: Comparison) -> str:
    return f"{comparison.set_up.machine}, {comparison.set_up.ground}"


def _rows(found: list[Comparison]) -> list[list[str]]:
    return [
        [
            page.code(each.set_up.id),
            each.set_up.machine,
            each.set_up.ground,
            each.quantity,
            _picofarad(each.field),
            _picofarad(each.boundary),
            signed_percent(each.difference),
            percent(each.allowed),
            f"{each.over_errors:.2f}",
        ]
        for each in found
    ]


def _picofarad(estimate: Estimate) -> str:
    return picofarads(estimate.value, estimate.error)
