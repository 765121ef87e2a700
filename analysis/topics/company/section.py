"""Experiment VII in the report: the factors of the change, figures of them, and the model beside it."""

from __future__ import annotations

import math
from collections.abc import Iterable

import plotly.graph_objects as go
from markupsafe import Markup

from analysis.report import page
from analysis.report.plot import INK, Panel, figure, log_axis, marks, rows_axis, series_colour
from analysis.results.units import percent
from analysis.topics.company.factors import (
    CONNECTIONS,
    PARTS,
    TOGETHER,
    Entry,
    Factor,
    factors,
    of_connection,
    of_model,
    of_part,
)
from analysis.topics.company.set_ups import MACHINES, NOTHING, RTOL, TO_GROUND
from analysis.topics.spread import ratio, spread
from geometries.common.measured import PICOFARAD, picofarads
from geometries.studies.families import FLOATING, GROUNDED

TITLE = "In company: Experiment VII"
ABSENT = (
    "This version of the model has no study of readings in company yet: python3 -m analysis company does it in a "
    "minute or two."
)
_WHAT = (
    "Change: the reading with the hand less that without it, the rest of the scene as it is. Each factor divides the changes of two set-ups "
    "that differ only in what the row names; a factor of one means that it does not matter. The machine's housing, "
    "the table and the second person are grounded; the guard is driven with the sensor. The hand is connected to the ground through a "
    "capacitance, as a person's body is, or floating, without net charge. Error: the largest relative error of a factor, "
    "from the errors that boundary elements state. Definitions: analysis/topics/experiments/EXPERIMENTS.md."
)


def section(found: list[Entry], checked: list[Markup]) -> Markup:
    """Returns the section, with what the field solver finds; one sentence without answers."""
    if not factors(found):
        return page.section(TITLE, page.paragraph(ABSENT))
    return page.section(
        TITLE,
        page.finding(finding(found)),
        page.figures([_plot_of_factors(found)]),
        page.table_of(
            factors(found),
            ("what", lambda each: each.what),
            ("against", lambda each: each.against),
            ("pairs", lambda each: str(len(each.ratios))),
            ("median", lambda each: f"{each.spread.median:.3f}"),
            ("smallest", lambda each: f"{each.spread.least:.3f}"),
            ("largest", lambda each: f"{each.spread.greatest:.3f}"),
            ("error", lambda each: f"{each.error:.1e}"),
        ),
        page.paragraph(
            "The same apart, median, and from smallest to largest: each part by the hand's connection,"
        ),
        page.table(["part", *_hands(TO_GROUND)], _rows_of_parts(found)),
        page.paragraph("and each connection, against the grounded hand, by the company."),
        page.table(["in company of", *_hands(CONNECTIONS)], _rows_of_connections(found)),
        page.finding(model_finding(found)),
        page.paragraph("The model's change over the true one:"),
        page.table(["in company of", *_hands(TO_GROUND)], _rows_of_model(found)),
        page.finding(conclusion(found)),
        page.soft(_WHAT),
        *checked,
        page.folded("Show the numbers", _numbers(found)),
    )


def finding(found: list[Entry]) -> str:
    """Tells by how much the machine's parts and the hand's connection change the change."""
    phrases = []
    for part in PARTS:
        grounded, floating = (of_part(found, part, (ground,)) for ground in (GROUNDED, FLOATING))
        if grounded.ratios and floating.ratios:
            phrases.append(
                f"{part} {grounded.spread.range} of a grounded hand and {floating.spread.range} of a floating one"
            )
    phrases += [
        f"{each.what} instead of grounded {each.spread.range}"
        for each in factors(found)
        if each.against == GROUNDED
    ]
    return (
        f"Over {len(found)} set-ups, solved by boundary elements asked for {percent(RTOL)}, the change that a hand makes is multiplied, in "
        f"the median and from least to most, by: {'; '.join(phrases)}."
    )


def model_finding(found: list[Entry]) -> str:
    """Tells how far the model's change is from the true one alone, and in company."""
    alone = of_model(found, NOTHING, GROUNDED)
    each = [of_model(found, machine, ground) for machine in MACHINES for ground in TO_GROUND]
    ratios = [ratio.value for factor in each for ratio in factor.ratios]
    if not alone.ratios:
        return "The model has no answer for a grounded hand before a sensor by itself."
    one, all_ = alone.spread, spread(ratios)
    assert all_ is not None
    return (
        f"The model, which knows neither company nor connections, gives {ratio(one.median)} times ({ratio(one.least)} to {ratio(one.greatest)}) the true change for "
        f"a grounded hand before a sensor by itself; over all set-ups {ratio(all_.median)} times it ({ratio(all_.least)} to {ratio(all_.greatest)})."
    )


def conclusion(found: list[Entry]) -> str:
    """Says what one may conclude from the factors for a threshold."""
    made = factors(found)
    told = [
        "A threshold found for a grounded hand in free space does not hold on a machine: before a housing a floating hand "
        f"makes {each.spread.range} of that change."
        for each in made
        if each.what == TOGETHER
    ]
    single = [each for each in made if each.what != TOGETHER]
    strongest = max(single, key=lambda each: abs(math.log(each.spread.median)))
    widest = max(single, key=lambda each: each.spread.greatest / each.spread.least)
    told.append(
        f"The strongest effect in the median is that of {strongest.what} ({strongest.spread.median:.3g}); the one that depends most on sizes and "
        f"distances is that of {widest.what} ({widest.spread.least:.3g} to {widest.spread.greatest:.3g}). No constant stands for it: a scene has to hold "
        "the machine and the hand's connection to the ground."
    )
    return " ".join(told)


def _rows_of_parts(found: list[Entry]) -> list[list[str]]:
    return _cells({part: [of_part(found, part, (ground,)) for ground in TO_GROUND] for part in PARTS})


def _rows_of_connections(found: list[Entry]) -> list[list[str]]:
    return _cells(
        {
            machine: [of_connection(found, ground, (machine,)) for ground in CONNECTIONS]
            for machine in MACHINES
        }
    )


def _rows_of_model(found: list[Entry]) -> list[list[str]]:
    return _cells(
        {machine: [of_model(found, machine, ground) for ground in TO_GROUND] for machine in MACHINES}
    )


def _cells(rows: dict[str, list[Factor]]) -> list[list[str]]:
    """Returns the rows that have any ratio, with their names."""
    return [
        [name, *(factor.spread.range if factor.ratios else "" for factor in row)]
        for name, row in rows.items()
        if any(factor.ratios for factor in row)
    ]


def _hands(grounds: Iterable[str]) -> list[str]:
    return [f"hand: {ground}" for ground in grounds]


def _numbers(found: list[Entry]) -> Markup:
    return page.table_of(
        found,
        ("set-up", lambda entry: page.code(entry.set_up.id)),
        ("arrangement", lambda entry: str(entry.set_up.number)),
        ("in company of", lambda entry: entry.set_up.machine),
        ("hand", lambda entry: entry.set_up.ground),
        ("background (pF)", lambda entry: picofarads(entry.background.value, entry.background.error)),
        ("change (pF)", lambda entry: picofarads(entry.change.value, entry.change.error)),
        ("model (pF)", lambda entry: "" if entry.model is None else f"{entry.model / PICOFARAD:.4f}"),
        text_columns=4,
    )


# Height (pixels) of a row of points, and of what is around the rows.
_ROW, _AROUND = 34, 150
_CONNECTED = tuple(ground for ground in TO_GROUND if ground != FLOATING)


def _plot_of_factors(found: list[Entry]) -> Panel:
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


def _points(name: str, made: list[Factor], colour: str) -> go.Scatter:
    points = [(factor.what, ratio) for factor in made for ratio in factor.ratios]
    marker = {"color": colour, "size": 7, "opacity": 0.45}
    values, whats, ids = (
        [each.value for _, each in points],
        [what for what, _ in points],
        [each.id for _, each in points],
    )
    return marks(name, values, whats, marker, "%{x:.4g}<br>set-up %{text}<extra>%{y}</extra>", text=ids)


def _medians(made: list[Factor]) -> go.Scatter:
    marker = {"color": INK, "symbol": "line-ns-open", "size": 20, "line": {"width": 3}}
    medians, whats = [factor.spread.median for factor in made], [factor.what for factor in made]
    return marks("median", medians, whats, marker, "median %{x:.4g}<extra>%{y}</extra>")
