"""Experiment VIII as a topic: what insulators before a sensor make of its reading, and the model's layer rule beside it."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

from markupsafe import Markup

from analysis.report import page
from analysis.report.plot import Panel, axis, boxes, figure, log_axis, marks, rows_axis, series_colour
from analysis.results.answers import Estimate
from analysis.results.statistics import Spread, grouped, range_of, spread
from analysis.results.store import Document
from analysis.results.units import percent, signed_percent
from analysis.topics.insulators import set_ups
from analysis.topics.insulators.set_ups import BLANKET, COVER, FILM, IGNORING, REDUCED, TARGET, SetUp
from analysis.topics.topic import Topic


@dataclass(frozen=True, eq=False)
class Entry:
    """A set-up; `changes` holds the change (F) by the reduced method, with the insulator and without it, where it answers."""

    set_up: SetUp
    true: set_ups.Truths
    changes: dict[str, Estimate]

    @property
    def factor(self) -> float:
        """The true change with the insulator over that without it; of an insulating target over that of a grounded one."""
        return self.true.insulated.change.value / self.true.without.change.value

    @property
    def uncertainty(self) -> float:
        """The relative error of the factor."""
        both = self.true.insulated.change, self.true.without.change
        return sum(change.error / abs(change.value) for change in both)

    def error(self, method: str) -> float:
        """Returns a change by the reduced method over the true one with the insulator, less one."""
        return self.changes[method].value / self.true.insulated.change.value - 1

    @property
    def is_enclosed(self) -> bool:
        """Tells whether the true change lies within the error that the reduced method states."""
        return self.changes[REDUCED].agrees_with(self.true.insulated.change)


def by_family(found: list[Entry]) -> dict[str, list[Entry]]:
    """Returns the entries of each family that has any."""
    return grouped(found, lambda entry: entry.set_up.family)


def _of(family: str, found: list[Entry]) -> list[Entry]:
    return [entry for entry in found if entry.set_up.family == family]


def errors(found: Iterable[Entry], method: str) -> Spread | None:
    """Returns the statistics of the reduced method's relative errors, of those entries for which it has an answer."""
    return spread(entry.error(method) for entry in found if method in entry.changes)


def _factors(found: Iterable[Entry]) -> Spread | None:
    return spread(entry.factor for entry in found)


def _false(found: Iterable[Entry]) -> Spread | None:
    """Returns what the insulator alone adds to the reading, over the change by the hand without it."""
    both = ((entry.true.insulated.background, entry.true.without) for entry in found)
    return spread((own.value - without.background.value) / without.change.value for own, without in both)


def entry(set_up: SetUp, answer: Document) -> Entry:
    """Returns a set-up with its answer."""
    changes = {name: Estimate(**each) for name, each in answer["changes"].items() if "refused" not in each}
    return Entry(set_up, set_ups.read(answer["truths"]), changes)


TITLE = "Insulators: Experiment VIII"
ABSENT = "This version of the model has no study of insulators yet: python3 -m analysis insulators does it in a minute."
_WHAT = (
    "Change: the reading with the hand less that without it, the insulator as it is; a blanket comes with the hand. Factor: the change with the insulator over that "
    "without it, and of an insulating target over that of a grounded one of the same shape. False change: what the insulator by itself adds to the reading, over the "
    "change by the hand without it. Layer rule: a covered plate counts as moved to the front by its cover's thickness times (1 − 1/permittivity), and the reduced method "
    "keeps the plate behind it. Insulating targets: the reduced method has bounds, the changes without them and with conductors in their place, and an estimate "
    "between both. Mattresses belong to the machine and are left to boundary elements. Definitions: analysis/topics/experiments/EXPERIMENTS.md."
)


def section(found: list[Entry], checked: list[Markup]) -> Markup:
    """Returns the section, with what the field solver finds."""
    return page.section(
        TITLE,
        page.finding(finding(found)),
        page.figures([of_families(found), of_layers(found)]),
        page.table_of(
            by_family(found).items(),
            ("family", lambda each: each[0]),
            ("set-ups", lambda each: str(len(each[1]))),
            ("factor: median (least to greatest)", lambda each: range_of(_factors(each[1]))),
            ("false change", lambda each: "" if each[0] in (BLANKET, TARGET) else range_of(_false(each[1]))),
            ("error of the factor", lambda each: percent(max(entry.uncertainty for entry in each[1]))),
        ),
        page.finding(warnings(found)),
        page.figures([of_targets(found)]),
        page.finding(rule_finding(found)),
        page.table(
            ["family", "reduced method", "answers", "rms error", "median", "worst", "within stated errors"],
            _rows_of_model(found),
            text_columns=2,
        ),
        page.soft(_WHAT),
        *checked,
        page.folded("Show the numbers", _numbers(found)),
    )


def finding(found: list[Entry]) -> str:
    """Tells by how much each kind of insulator multiplies the change."""
    others = ((family, members) for family, members in by_family(found).items() if family != TARGET)
    phrases = [f"a {family} {range_of(_factors(members))}" for family, members in others]
    sure = spread(entry.uncertainty for entry in found)
    assert sure is not None
    return (
        f"Over {len(found)} set-ups insulators multiply the change that a hand makes, in the median and from least to most, by: {'; '.join(phrases)}. The factors are "
        f"known to {percent(sure.median)} in the median and {percent(sure.greatest)} at worst, by boundary elements asked for {percent(set_ups.RTOL)} of each entry and change."
    )


def warnings(found: list[Entry]) -> str:
    """Says in numbers what manuals warn of: keep dry, and insulating objects are not seen."""
    told = []
    wet = _false(_of(FILM, found))
    if wet:
        told.append(
            "Keep dry: a wet film of half a millimetre adds to the reading, before any hand comes, "
            f"{range_of(wet)} of the change by the hand."
        )
    seen = _factors(_of(TARGET, found))
    if seen:
        told.append(
            f"Insulating objects are seen less, not unseen: they make {range_of(seen)} of the change by a grounded one of the same shape."
        )
    return " ".join(told)


def rule_finding(found: list[Entry]) -> str:
    """Tells how far off the reduced method is under layers, with the layer rule and without it."""
    phrases = []
    for family in (COVER, FILM):
        ruled, ignoring = (errors(_of(family, found), method) for method in (REDUCED, IGNORING))
        if ruled and ignoring:
            phrases.append(
                f"under a {family} {percent(ruled.rms)} rms and {signed_percent(ruled.worst)} at worst ({percent(ignoring.rms)} and "
                f"{signed_percent(ignoring.worst)} without regard to the layer)"
            )
    return f"The reduced method, with the layer rule, is off by: {'; '.join(phrases)}."


def _rows_of_model(found: list[Entry]) -> list[list[str]]:
    rows = []
    for family, members in by_family(found).items():
        for method, name in ((REDUCED, "as it is"), (IGNORING, "without regard to the insulator")):
            each = errors(members, method)
            if family == TARGET and method == IGNORING:
                continue
            if each is None:
                rows.append([family, name, f"refuses all {len(members)}", "", "", "", ""])
                continue
            enclosed = sum(entry.is_enclosed for entry in members if REDUCED in entry.changes)
            within = f"{enclosed} of {each.count}" if method == REDUCED else ""
            of_errors = percent(each.rms), signed_percent(each.median), signed_percent(each.worst)
            rows.append([family, name, str(each.count), *of_errors, within])
    return rows


def _numbers(found: list[Entry]) -> Markup:
    return page.table_of(
        found,
        ("set-up", lambda entry: page.code(entry.set_up.id)),
        ("name", lambda entry: entry.set_up.name),
        ("permittivity", lambda entry: f"{entry.set_up.permittivity:g}"),
        ("thickness (mm)", lambda entry: f"{1e3 * entry.set_up.thickness:.1f}"),
        ("distance (mm)", lambda entry: f"{1e3 * entry.set_up.gap:.1f}"),
        ("change (pF)", lambda entry: entry.true.insulated.change.in_picofarads),
        ("without (pF)", lambda entry: entry.true.without.change.in_picofarads),
        ("reduced (pF)", _reduced),
        text_columns=2,
    )


def _reduced(entry: Entry) -> str:
    return entry.changes[REDUCED].in_picofarads if REDUCED in entry.changes else "refused"


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
        members, marker = _of(family, found), {"color": series_colour(index), "size": 6}
        layers = [entry.set_up for entry in members]
        shifts = [each.thickness * (1 - 1 / each.permittivity) / each.gap for each in layers]
        added = [_PERCENT * (entry.factor - 1) for entry in members]
        bars, names = [_PERCENT * entry.uncertainty for entry in members], _names(members)
        traces.append(marks(family, shifts, added, marker, _HOVER, bars, text=names))
    x = log_axis("thickness · (1 − 1/permittivity) over the distance of the hand")
    return Panel("what layers add to the change", figure(traces, x, axis("added to the change (%)")))


def of_targets(found: list[Entry]) -> Panel:
    """Plots the change by insulating targets over that by grounded ones, over their permittivity; the reduced method's estimates beside the truth."""
    members = _of(TARGET, found)
    unknown = Estimate(math.nan, math.nan)
    known = [(entry.changes.get(REDUCED, unknown), entry.true.without.change) for entry in members]
    estimates = [found.value / without.value for found, without in known]
    shown = {"true change": ("circle", [entry.factor for entry in members])}
    shown["estimate"] = "x-thin-open", estimates
    permittivities, traces = [entry.set_up.permittivity for entry in members], []
    for index, (name, (symbol, values)) in enumerate(shown.items()):
        marker = {"color": series_colour(index), "size": 7, "symbol": symbol}
        traces.append(marks(name, permittivities, values, marker, _HOVER, text=_names(members)))
    x = log_axis("relative permittivity of the target")
    return Panel("insulating targets", figure(traces, x, log_axis("change over that by a grounded target")))


def _names(found: list[Entry]) -> list[str]:
    return [entry.set_up.name for entry in found]


INSULATORS = Topic[SetUp, Entry](
    stages=set_ups.STAGES,
    set_ups=lambda: set_ups.all_set_ups(),
    entry=entry,
    sections=lambda found, checked, _: [section(found, checked)],
    finding=finding,
    absent=ABSENT,
    title="The model before insulators",
    question="What do insulators before a sensor change?",
    short="insulators",
    reproduce=(
        "From the project's folder: the reading of a set-up, which is named as in the numbers; the comparison of all; and the true changes and the field "
        "solver's readings that are not stored."
    ),
    truths=set_ups.STORED,
    check=set_ups.CHECK,
    is_quick=True,
)
