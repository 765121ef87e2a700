"""Experiment VII in the report: what company makes of the change of a reading, as factors with figures of them, and the model beside it."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from markupsafe import Markup

from analysis.report import page
from analysis.report.plot import INK, Panel, figure, log_axis, marks, rows_axis, series_colour
from analysis.results.answers import Estimate
from analysis.results.statistics import Spread, ratio, spread
from analysis.results.store import Document
from analysis.results.units import percent
from analysis.topics.company import set_ups
from analysis.topics.company.set_ups import GUARD, HOUSING, MACHINES, NOTHING, PERSON, TABLE, TO_GROUND, SetUp
from analysis.topics.stored import QUANTITIES
from analysis.topics.topic import Topic
from geometries.common.measured import PICOFARAD
from geometries.studies.families import FLOATING, GROUNDED

PARTS = {
    "housing": (HOUSING, NOTHING),
    "driven guard": (GUARD, HOUSING),
    "table": (TABLE, NOTHING),
    "second person": (PERSON, NOTHING),
}
"""Part of a machine → the machines with it and without it, whose changes are divided."""
CONNECTIONS = tuple(ground for ground in TO_GROUND if ground != GROUNDED)
"""The hand's connections whose changes are divided by that of the grounded hand."""
TOGETHER = "housing, hand floating"
Kind = tuple[str, str]
"""A machine and a connection of the hand."""


@dataclass(frozen=True)
class Entry:
    """A set-up with value, background and change of its reading; `model` is the model's change, None unless the hand is grounded (F)."""

    set_up: SetUp
    value: Estimate
    background: Estimate
    change: Estimate
    model: float | None


@dataclass(frozen=True)
class Ratio:
    """A change over another one, of two set-ups that differ in one respect; `error` is relative, `id` is the first set-up's."""

    id: str
    value: float
    error: float


@dataclass(frozen=True)
class Factor:
    """The ratios of all set-ups that differ in `what` from those without it (`against`)."""

    what: str
    against: str
    ratios: tuple[Ratio, ...]

    @property
    def spread(self) -> Spread:
        """How the ratios are spread, of which there must be one."""
        found = spread(ratio.value for ratio in self.ratios)
        assert found is not None
        return found

    @property
    def error(self) -> float:
        """The largest relative error of a ratio."""
        return max(ratio.error for ratio in self.ratios)


def factors(found: list[Entry]) -> list[Factor]:
    """Returns what each part of a machine, and each connection of the hand but the grounded one, makes of the change; those
    for which there is any pair of set-ups."""
    made = [of_part(found, part, tuple(TO_GROUND)) for part in PARTS]
    made += [of_connection(found, ground, MACHINES) for ground in CONNECTIONS]
    made.append(_factor(TOGETHER, "neither", found, [((HOUSING, FLOATING), (NOTHING, GROUNDED))]))
    return [factor for factor in made if factor.ratios]


def of_part(found: list[Entry], part: str, grounds: tuple[str, ...]) -> Factor:
    """Returns what a part of a machine makes of the change, over some connections of the hand; perhaps without any ratio."""
    machine, without = PARTS[part]
    pairs = [((machine, ground), (without, ground)) for ground in grounds]
    return _factor(part, "without it", found, pairs)


def of_connection(found: list[Entry], ground: str, machines: tuple[str, ...]) -> Factor:
    """Returns what the hand's connection makes of the change, over some machines; perhaps without any ratio."""
    pairs = [((machine, ground), (machine, GROUNDED)) for machine in machines]
    return _factor(_hand(ground), "grounded", found, pairs)


def of_model(found: list[Entry], machine: str, ground: str) -> Factor:
    """Returns the model's change, that of the grounded hand, over the true one; perhaps without any ratio."""
    model = {number: entry.model for number, entry in _of(found, machine, GROUNDED).items()}
    ratios = tuple(
        Ratio(each.set_up.id, by_model / each.change.value, each.change.error / each.change.value)
        for number, each in _of(found, machine, ground).items()
        if (by_model := model.get(number)) is not None
    )
    return Factor(f"{machine}, {_hand(ground)}", "truth", ratios)


def _hand(ground: str) -> str:
    return f"hand {ground}" if ground in (GROUNDED, FLOATING) else f"hand through {ground}"


def _factor(what: str, against: str, found: list[Entry], pairs: Iterable[tuple[Kind, Kind]]) -> Factor:
    """Divides the changes of a machine and a connection by those of others, arrangement by arrangement."""
    ratios = []
    for these, those in pairs:
        above, below = _of(found, *these), _of(found, *those)
        for number in sorted(above.keys() & below.keys()):
            one, other = above[number].change, below[number].change
            # Both errors may have the same cause or opposite ones: their sizes are added.
            error = one.error / one.value + other.error / other.value
            ratios.append(Ratio(above[number].set_up.id, one.value / other.value, error))
    return Factor(what, against, tuple(ratios))


def _of(found: list[Entry], machine: str, ground: str) -> dict[int, Entry]:
    own = (entry for entry in found if (entry.set_up.machine, entry.set_up.ground) == (machine, ground))
    return {entry.set_up.number: entry for entry in own}


def entry(set_up: SetUp, document: Document) -> Entry:
    """Returns a set-up with its answer."""
    return Entry(set_up, **{name: Estimate(**document[name]) for name in QUANTITIES}, model=document["model"])


TITLE = "In company: Experiment VII"
ABSENT = "This version of the model has no study of readings in company yet: python3 -m analysis company does it in a minute or two."
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
    company = "in company of"
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
        _table("part", TO_GROUND, PARTS, lambda part, ground: of_part(found, part, (ground,))),
        page.paragraph("and each connection, against the grounded hand, by the company."),
        _table(company, CONNECTIONS, MACHINES, lambda one, ground: of_connection(found, ground, (one,))),
        page.finding(model_finding(found)),
        page.paragraph("The model's change over the true one:"),
        _table(company, TO_GROUND, MACHINES, lambda machine, ground: of_model(found, machine, ground)),
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
            of_grounded = f"{grounded.spread.range} of a grounded hand"
            phrases.append(f"{part} {of_grounded} and {floating.spread.range} of a floating one")
    connections = (each for each in factors(found) if each.against == GROUNDED)
    phrases += [f"{each.what} instead of grounded {each.spread.range}" for each in connections]
    return (
        f"Over {len(found)} set-ups, solved by boundary elements asked for {percent(set_ups.RTOL)}, the change that a hand makes is multiplied, in "
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


def _table(
    what: str, grounds: Iterable[str], rows: Iterable[str], factor: Callable[[str, str], Factor]
) -> Markup:
    """Returns the factors of each row by the hand's connection; rows without any ratio are left out."""
    known = {name: [factor(name, ground) for ground in grounds] for name in rows}
    return page.table(
        [what, *(f"hand: {ground}" for ground in grounds)],
        [
            [name, *(each.spread.range if each.ratios else "" for each in row)]
            for name, row in known.items()
            if any(each.ratios for each in row)
        ],
    )


def _numbers(found: list[Entry]) -> Markup:
    return page.table_of(
        found,
        ("set-up", lambda entry: page.code(entry.set_up.id)),
        ("arrangement", lambda entry: str(entry.set_up.number)),
        ("in company of", lambda entry: entry.set_up.machine),
        ("hand", lambda entry: entry.set_up.ground),
        ("background (pF)", lambda entry: entry.background.in_picofarads),
        ("change (pF)", lambda entry: entry.change.in_picofarads),
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
    traces, hover = [], "%{x:.4g}<br>set-up %{text}<extra>%{y}</extra>"
    for index, (name, own) in enumerate(split.items()):
        points = [(each.value, factor.what, each.id) for factor in own for each in factor.ratios]
        values, whats, ids = zip(*points) if points else ((), (), ())
        look = {"color": series_colour(index), "size": 7, "opacity": 0.45}
        traces.append(marks(name, values, whats, look, hover, text=ids))
    marker = {"color": INK, "symbol": "line-ns-open", "size": 20, "line": {"width": 3}}
    medians = [factor.spread.median for factor in made]
    traces.append(marks("median", medians, names, marker, "median %{x:.4g}<extra>%{y}</extra>"))
    x = log_axis("change over the change without it")
    return Panel(
        "what the company and the hand's connection make of the change",
        figure(traces, x, rows_axis(names), height=_AROUND + _ROW * len(names)),
    )


COMPANY = Topic[SetUp, Entry](
    stages=set_ups.STAGES,
    set_ups=lambda: set_ups.all_set_ups(),
    entry=entry,
    sections=lambda found, checked, _: [section(found, checked)],
    finding=finding,
    absent=ABSENT,
    title="The model in company",
    question="What does a machine around the sensor change?",
    short="in company",
    reproduce="From the project's folder: the readings of a set-up, which is named as in the numbers, and those of all that have none yet.",
    check=set_ups.CHECK,
)
