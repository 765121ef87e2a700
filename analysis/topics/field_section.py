"""Readings by two methods: those by boundary elements beside the field solver's, and the intervals that are proven."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np
from markupsafe import Markup

from analysis.report import page
from analysis.report.plot import Panel, axis, figure, log_axis, marks, series_colour
from analysis.results.answers import Estimate
from analysis.results.units import percent, signed_percent
from analysis.topics.field_solver import Comparison, FieldCheck
from geometries.common.measured import PICOFARAD, picofarads

TITLE = "Checked by the field solver"
ABSENT = "None of these set-ups has a reading by the field solver."
GOAL = 5e-3
"""Largest difference of the methods, relative to the field solver's value, that there should be."""
Column = tuple[str, Callable[[Comparison[Any]], str]]
_PERCENT = 100.0
_WHAT = (
    "Bars: the sum of the errors that both methods state; where they contain zero, the methods agree. The field solver's readings are kept with "
    "the project."
)


def parts(check: FieldCheck[Any], found: list[Comparison[Any]]) -> list[Markup]:
    """Returns the title, the finding, the figure and the numbers."""
    if not found:
        return [page.heading(TITLE), page.paragraph(ABSENT)]
    return [
        page.heading(TITLE),
        page.finding(finding(check, found)),
        page.figures([_differences(check, found)]),
        page.soft(f"{_WHAT} {check.explanation}".strip()),
        page.folded("Show the comparison", _table(check, found)),
    ]


def finding(check: FieldCheck[Any], found: list[Comparison[Any]]) -> str:
    """Tells how many values agree, and the largest difference of each quantity; how many lie in the intervals that are proven; and which do not."""
    kinds = Counter({each.set_up.identity: check.kind(each.set_up) for each in found}.values())
    agreeing = sum(each.over_errors <= 1 for each in found)
    told = [
        f"In {kinds.total()} set-ups that the field solver computes, too ({', '.join(f'{kind} {count}' for kind, count in kinds.items())}), "
        f"{agreeing} of {len(found)} values agree within the errors that both methods state. Boundary elements less field solver: "
        f"{'; '.join(_of_quantity(quantity, found) for quantity in check.quantities)}."
    ]
    proven = [each for each in found if each.is_proven]
    if proven:
        half_width = float(np.median([each.half_width for each in proven]))
        told.append(
            f"{sum(each.is_enclosed for each in proven)} of {len(proven)} values by boundary elements lie in the interval that the field solver proves, whose "
            f"half-width is {percent(half_width)} of the value in the median."
        )
    apart = [each for each in found if each.over_errors > 1 or not each.is_enclosed]
    if apart:
        named = (f"{each.quantity} of {each.set_up.name} ({each.over_errors:.2f})" for each in apart)
        told.append(f"Beyond their errors: {', '.join(named)}.")
    return " ".join(told)


def _of_quantity(quantity: str, found: list[Comparison[Any]]) -> str:
    own = [each for each in found if each.quantity == quantity]
    worst = max(each.over_errors for each in own)
    farthest = max((each.difference for each in own), key=abs)
    near, stated = (
        sum(abs(each.difference) <= GOAL for each in own),
        sum(each.over_errors <= 1 for each in own),
    )
    return (
        f"{quantity} {stated} of {len(own)} within the errors and {near} within {percent(GOAL)}, at most {worst:.2f} of the errors and "
        f"{signed_percent(farthest)} of the value"
    )


def _differences(check: FieldCheck[Any], found: list[Comparison[Any]]) -> Panel:
    """Plots the differences over the size of the value: a colour for each quantity, or of a single one for each kind of set-up."""
    is_one = len(check.quantities) == 1
    groups: dict[str, list[Comparison[Any]]] = {}
    for each in found:
        groups.setdefault(check.kind(each.set_up) if is_one else each.quantity, []).append(each)
    traces = [
        marks(
            name,
            [abs(each.field.value) / PICOFARAD for each in members],
            [_PERCENT * each.difference for each in members],
            {"color": series_colour(index), "size": 7},
            "%{y:+.3f} %<br>%{text}",
            [_PERCENT * each.allowed for each in members],
            text=[each.set_up.name for each in members],
        )
        for index, (name, members) in enumerate(groups.items())
    ]
    y = axis("boundary elements less field solver (%)", zeroline=True, zerolinewidth=2)
    what = check.quantities[0] if is_one else "value"
    return Panel("both methods, set-up by set-up", figure(traces, log_axis(f"size of the {what} (pF)"), y))


def _table(check: FieldCheck[Any], found: list[Comparison[Any]]) -> Markup:
    proven: list[Column] = [
        (
            "proven to lie between (pF)",
            lambda each: " and ".join(f"{end / PICOFARAD:.4g}" for end in each.proven),
        ),
        ("within", lambda each: page.yes_or_no(each.is_enclosed)),
    ]
    columns: list[Column] = [
        *((title, _of_set_up(shown)) for title, shown in check.described),
        ("quantity", lambda each: each.quantity),
        ("field solver (pF)", lambda each: _picofarad(each.field)),
        ("boundary elements (pF)", lambda each: _picofarad(each.boundary)),
        ("difference", lambda each: signed_percent(each.difference)),
        ("errors", lambda each: percent(each.allowed)),
        ("difference/errors", lambda each: f"{each.over_errors:.2f}"),
        *(proven if found[0].is_proven else []),
    ]
    return page.table_of(found, *columns, text_columns=len(check.described) + 1)


def _of_set_up(shown: Callable[[Any], str]) -> Callable[[Comparison[Any]], str]:
    return lambda each: shown(each.set_up)


def _picofarad(estimate: Estimate) -> str:
    return picofarads(estimate.value, estimate.error)
