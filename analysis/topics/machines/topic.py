"""The model on machines as a topic: how far its change of a reading is from the true one there, and why."""

import math
from collections import Counter
from dataclasses import dataclass
from functools import partial

import numpy as np
import plotly.graph_objects as go
from markupsafe import Markup

from analysis.report import page, plot
from analysis.report.plot import Panel, axis, boxes, figure, marks, power_axis, rows_axis, series_colour
from analysis.results.answers import Estimate
from analysis.results.statistics import Spread, grouped, range_of, ratio, spread
from analysis.results.store import Document
from analysis.results.units import signed_percent
from analysis.topics.machines import parts, set_ups, truths
from analysis.topics.machines.parts import ALL_PARTS, COMPANY, OnMachine, Pairs
from analysis.topics.machines.set_ups import FAMILIES, SetUp
from analysis.topics.machines.truths import CHECK, METHODS, RTOL, STAGES
from analysis.topics.topic import Topic


@dataclass(frozen=True, eq=False)
class Entry:
    """A set-up; `methods` holds the change (F) by each method that answers. `pairs` is None for a reading between two sensors."""

    set_up: SetUp
    true: OnMachine
    pairs: Pairs | None
    methods: dict[str, float]

    @property
    def change(self) -> Estimate:
        """The true change (F)."""
        return self.true.full

    def ratio(self, method: str) -> float:
        """Returns a method's change over the true one; not a number if the method has no answer."""
        return self.methods.get(method, math.nan) / self.change.value

    @property
    def error(self) -> float:
        """(model − truth)/truth, by the model with all triangles; −1 for a reading between sensors, of which the model gives nothing."""
        return (self.pairs.every if self.pairs else 0.0) / self.change.value - 1

    def parts(self) -> dict[str, float]:
        """Returns the parts of the relative error, which add up to it; 0 for what the set-up does not have."""
        company = {name: part.value for name, part in self.true.company().items()}
        pair = self.pairs.parts() if self.pairs else {parts.NOT_KNOWN: -self.true.alone.value}
        found = company | pair
        return {name: found.get(name, 0.0) / self.change.value for name in ALL_PARTS}

    @property
    def largest(self) -> str:
        """The name of the largest part."""
        found = self.parts()
        return max(found, key=lambda name: abs(found[name]))


@dataclass(frozen=True)
class OfPart:
    """A part over the set-ups that have it, relative to the truth. `largest_in` counts where it is the greatest part."""

    name: str
    spread: Spread
    largest_in: int


def statistics(found: list[Entry], method: str) -> Spread | None:
    """Returns how a method's changes over the true ones are spread, about 1; None if it answers none of the set-ups."""
    return spread((entry.ratio(method) for entry in found), true=1.0)


def mean_parts(found: list[Entry]) -> list[OfPart]:
    """Returns every part that some set-up has."""
    named = {name: spread(value for entry in found if (value := entry.parts()[name])) for name in ALL_PARTS}
    largest = Counter(entry.largest for entry in found)
    return [OfPart(name, own, largest[name]) for name, own in named.items() if own]


def entry(set_up: SetUp, document: Document) -> Entry:
    """Returns a set-up with its answer."""
    pairs = None if document["pairs"] is None else Pairs.read(document["pairs"])
    methods = {name: each["change"] for name, each in document["methods"].items() if "change" in each}
    return Entry(set_up, OnMachine.read(document["changes"]), pairs, methods)


TITLE = "On machines"
ABSENT = "This version of the model has no study of machines yet: python3 -m analysis machines does it in a minute."
_WHAT = (
    "Change: the reading with the target less that without it, the machine as it is. A part is the decrease of the change when what it names is "
    "included, over the true change; its mean over all orders of including, so that the parts add up to the error exactly. Nothing is fitted. The parts of "
    "the company are differences between true changes by boundary elements; the others are of the sensor and the target by themselves: faces turned away "
    "are triangles that the sensor does not see; another quantity is the charge on the target minus the change of the sensor's own; for a plate the rest is "
    "taken apart as in the page on two plates. The changes by exact and exact+facing are those of a grounded target: the plain model knows no other; the "
    "reduced method, asked for 10 %, knows company and floating targets. Of a reading between two sensors the plain model gives nothing; its error is then the whole change. Definitions: "
    "analysis/topics/machines/MACHINES.md."
)


def section(found: list[Entry], checked: list[Markup]) -> Markup:
    """Returns the section, with what the field solver finds."""
    return page.section(
        TITLE,
        page.finding(finding(found)),
        page.figures([of_methods(found)]),
        page.table_of(
            grouped(found, lambda entry: entry.set_up.family).items(),
            ("family", lambda each: each[0]),
            ("set-ups", lambda each: str(len(each[1]))),
            *((f"{method}: median (least to greatest)", partial(_range, method)) for method in METHODS),
        ),
        page.finding(parts_finding(found)),
        page.figures([of_parts(found)]),
        page.table_of(
            mean_parts(found),
            ("part", lambda each: each.name),
            ("set-ups", lambda each: str(each.spread.count)),
            ("median", lambda each: f"{each.spread.median:+.3g}"),
            ("least", lambda each: f"{each.spread.least:+.3g}"),
            ("greatest", lambda each: f"{each.spread.greatest:+.3g}"),
            ("greatest part in", lambda each: f"{each.largest_in} of {len(found)}"),
        ),
        page.soft(_WHAT),
        page.paragraph("Sealed set-ups, which no rule was chosen by, and the others; error of the change:"),
        _sealed(found),
        *checked,
        page.folded("Show the numbers", _numbers(found)),
    )


def finding(found: list[Entry]) -> str:
    """Tells how many times the true change each method gives."""
    phrases = [
        f"{method} {ratio(each.median)} times ({ratio(each.least)} to {ratio(each.greatest)})"
        for method in METHODS
        if (each := statistics(found, method)) is not None
    ]
    sure = max(entry.change.error / abs(entry.change.value) for entry in found)
    return (
        f"Over {len(found)} set-ups on machines the model gives, in the median and from least to most, of the true change of the reading: "
        f"{'; '.join(phrases)}. The true changes are known to {signed_percent(sure).removeprefix('+')} or better, by boundary elements asked for {RTOL:g}."
    )


def parts_finding(found: list[Entry]) -> str:
    """Tells what company makes of the error, and which parts are the greatest."""
    pairs = [entry.true.alone.value / entry.change.value for entry in found if entry.pairs] or [np.nan]
    of_company = {}
    for name in COMPANY:
        own = [entry.parts()[name] for entry in found if name in entry.true.included]
        of_company[name] = float(np.median(own or [0.0]))
    strongest = max(COMPANY, key=lambda name: of_company[name])
    greatest = max(mean_parts(found), key=lambda each: each.largest_in)
    return (
        f"Company alone makes {ratio(float(np.median(pairs)))} times too much of a change ({ratio(min(pairs))} to {ratio(max(pairs))}): so much is the exact change "
        f"of the sensor and the target by themselves over that on the machine, and no better model of pairs can be nearer. Most of it is {strongest} "
        f"({of_company[strongest]:.2g} of the true change in the median). Of all parts {greatest.name} is the greatest most often, in {greatest.largest_in} "
        f"of {len(found)} set-ups."
    )


def _range(method: str, family: tuple[str, list[Entry]]) -> str:
    return range_of(statistics(family[1], method))


def _sealed(found: list[Entry]) -> Markup:
    """Returns how each method does in the sealed set-ups and in the others."""
    known = [
        (method, name, own)
        for method in METHODS
        for name, sealed in (("sealed", True), ("open", False))
        if (own := statistics([entry for entry in found if entry.set_up.sealed == sealed], method))
    ]
    return page.table_of(
        known,
        ("method", lambda each: each[0]),
        ("set-ups", lambda each: each[1]),
        ("count", lambda each: str(each[2].count)),
        ("median ratio", lambda each: ratio(each[2].median)),
        ("rms error", lambda each: f"{100 * each[2].rms:.0f} %"),
        ("worst error", lambda each: f"{100 * each[2].worst:+.0f} %"),
    )


def _numbers(found: list[Entry]) -> Markup:
    return page.table_of(
        found,
        ("set-up", lambda entry: page.code(entry.set_up.id)),
        ("name", lambda entry: entry.set_up.name),
        ("sealed", lambda entry: "yes" if entry.set_up.sealed else ""),
        ("change (pF)", lambda entry: entry.change.in_picofarads),
        ("pair (pF)", lambda entry: entry.true.alone.in_picofarads),
        *((method, partial(_ratio, method)) for method in METHODS),
        ("greatest part", lambda entry: entry.largest),
        text_columns=3,
    )


def _ratio(method: str, entry: Entry) -> str:
    return ratio(entry.ratio(method)) if method in entry.methods else ""


# Height (pixels) of a family's boxes, of a part's, and of what is around them.
_FAMILY, _PART, _AROUND = 82, 36, 150
_TICKS = (-100, -10, -1, 0, 1, 10, 100, 1000)


def of_methods(found: list[Entry]) -> Panel:
    """Plots each method's change over the true one, boxes for each family, with all points."""
    traces = []
    for index, method in enumerate(METHODS):
        answering = [entry for entry in found if method in entry.methods]
        points = [(entry.set_up.family, entry.ratio(method), entry.set_up.name) for entry in answering]
        traces.append(boxes(points, method, series_colour(index)))
    caption, height = "the model's change over the true one", _AROUND + _FAMILY * len(FAMILIES)
    x, y = power_axis(caption), rows_axis(list(FAMILIES))
    return Panel(caption, figure(traces, x, y, height, boxmode="group"))


def of_parts(found: list[Entry]) -> Panel:
    """Plots every part over the true change, a point for each set-up that has it."""
    there = [name for name in ALL_PARTS if any(entry.parts()[name] for entry in found)]
    traces = [_points(found, family, there) for family in FAMILIES]
    # Parts of either sign over five decades: linear up to the change itself, then logarithmic.
    places = {"tickvals": list(map(_place, _TICKS)), "ticktext": [f"{value:g}" for value in _TICKS]}
    x = axis("part of the error over the true change", **places)
    height = _AROUND + _PART * len(there)
    return Panel("the parts of the error", figure(traces, x, rows_axis(there), height))


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
    marker = plot.family_marker(family, list(FAMILIES), size=6, opacity=0.45)
    places, names = [_place(value) for _, value, _ in points], [name for name, _, _ in points]
    text = [f"{value:+.3g}<br>{name}" for _, value, name in points]
    return marks(family, places, names, marker, "%{text}<extra>%{y}</extra>", text=text)


MACHINES = Topic[SetUp, Entry](
    stages=STAGES,
    set_ups=lambda: set_ups.all_set_ups(),
    entry=entry,
    sections=lambda found, checked, _: [section(found, checked)],
    finding=finding,
    absent=ABSENT,
    title="The model on machines",
    question="How wrong is the model on a machine?",
    short="on machines",
    reproduce=(
        "From the project's folder: the reading of a set-up, which is named as in the numbers; the comparison of all; and the true changes that are not stored."
    ),
    truths=truths.STORED,
    check=CHECK,
)
