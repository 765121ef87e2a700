"""The true changes on machines by two methods: those by boundary elements beside the field solver's, and the intervals that are proven."""

from __future__ import annotations

import numpy as np
import plotly.graph_objects as go
from markupsafe import Markup

from analysis.report import page
from analysis.report.plot import Panel, axis, figure, log_axis, series_colour
from analysis.results.units import PICOFARAD, percent, picofarads, signed_percent
from analysis.topics.field_solver import Comparison as AnyComparison
from analysis.topics.machines.set_ups import FAMILIES, SetUp

Comparison = AnyComparison[SetUp]
ABSENT = "None of these set-ups has a change by the field solver."
_PERCENT = 100.0
_WHAT = (
    "The proven interval is the field solver's enclosure of the value less that of the background, so that it is wide where the change is a small part of the "
    "reading; its estimate of the change is far better. Bars: the sum of the errors that both methods state. The records are kept with the "
    "project: python3 -m analysis measure field-check machines makes them in an hour of one core, for set-ups of boxes and plates, which it meshes quickly."
)


def parts(found: list[Comparison]) -> list[Markup]:
    """Returns the finding, the figure and the numbers."""
    if not found:
        return [page.paragraph(ABSENT)]
    header = [
        "set-up",
        "field solver (pF)",
        "proven to lie between (pF)",
        "boundary elements (pF)",
        "difference",
        "errors",
        "difference/errors",
        "within",
    ]
    return [
        page.finding(finding(found)),
        page.figures([_differences(found)]),
        page.soft(_WHAT),
        page.folded("Show the comparison", page.table(header, _rows(found), text_columns=1)),
    ]


def finding(found: list[Comparison]) -> str:
    """Tells how many true changes lie in the proven intervals, and how well both methods agree."""
    enclosed = sum(each.is_enclosed for each in found)
    agreeing = sum(each.over_errors <= 1 for each in found)
    sealed = sum(each.set_up.sealed for each in found)
    farthest = max((each.difference for each in found), key=abs)
    half_width = float(np.median([each.half_width for each in found]))
    sentence = (
        f"The field solver, another method, encloses the change in {len(found)} of the set-ups, {sealed} of them sealed: {enclosed} of the {len(found)} true changes "
        f"by boundary elements lie in the interval that it proves, whose half-width is {percent(half_width)} of the change in the median. {agreeing} of "
        f"{len(found)} agree with its own value within the errors that both state; the largest difference is {signed_percent(farthest)}."
    )
    apart = [each.set_up.name for each in found if each.over_errors > 1 or not each.is_enclosed]
    return f"{sentence} Not so: {', '.join(apart)}." if apart else sentence


def _differences(found: list[Comparison]) -> Panel:
    traces: list[object] = []
    for index, family in enumerate(FAMILIES):
        members = [each for each in found if each.set_up.family == family]
        if not members:
            continue
        traces.append(
            go.Scatter(
                x=[abs(each.field.value) / PICOFARAD for each in members],
                y=[_PERCENT * each.difference for each in members],
                error_y={"array": [_PERCENT * each.allowed for each in members], "thickness": 1.5},
                mode="markers",
                marker={"color": series_colour(index), "size": 7},
                text=[each.set_up.name for each in members],
                name=family,
                hovertemplate="%{y:+.3f} %<br>%{text}<extra></extra>",
            )
        )
    y = axis("boundary elements less field solver (%)", zeroline=True, zerolinewidth=2)
    return Panel(
        "both methods, set-up by set-up",
        figure(traces, log_axis("size of the change of the reading (pF)"), y),
    )


def _rows(found: list[Comparison]) -> list[list[str]]:
    return [
        [
            each.set_up.name,
            picofarads(each.field.value, each.field.error),
            f"{each.proven[0] / PICOFARAD:.4g} and {each.proven[1] / PICOFARAD:.4g}",
            picofarads(each.boundary.value, each.boundary.error),
            signed_percent(each.difference),
            percent(each.allowed),
            f"{each.over_errors:.2f}",
            "yes" if each.is_enclosed else "no",
        ]
        for each in found
    ]
