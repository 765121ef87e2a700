"""Records of set-ups that are kept beside the code of their topic, by the hash of the scene, so that nobody has to solve them again: what is solved by
boundary elements, and readings by the field solver with their comparison and what a page says of it."""

import math
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, NamedTuple

import numpy as np
from markupsafe import Markup

from analysis.pipeline import reference_stage
from analysis.pipeline.set_up_stages import OfScene, SomeSetUp
from analysis.pipeline.stage import NoAnswer, Processes
from analysis.report import page
from analysis.report.plot import Panel, axis, figure, log_axis, marks, series_colour
from analysis.results.answers import Estimate
from analysis.results.statistics import grouped
from analysis.results.store import Document, read_json, write_json, write_text
from analysis.results.study_results import SCENE
from analysis.results.units import percent, signed_percent
from geometries.common.children import temporary_folder
from geometries.common.measured import PICOFARAD

_DIGITS = 7
"""Significant digits of a rounded value: far more than are true."""


class Completed(NamedTuple):
    """How many set-ups were solved, and how many remain without a record."""

    solved: int
    left: int


@dataclass(frozen=True)
class Stored(Generic[SomeSetUp]):
    """The records of the set-ups `chosen` in a file, in which they stand after the `description`. `solve`
    makes a record; NoAnswer where there is none."""

    file: Path
    description: str
    chosen: Callable[[], Iterable[SomeSetUp]]
    solve: Callable[[SomeSetUp], Document]

    @property
    def key(self) -> str:
        """What the records are called in the file: truths or checks."""
        return self.file.stem.removeprefix("field_")

    def records(self) -> Document:
        """Returns the records by the identity of their set-up's scene; none without a file."""
        found: Document = (read_json(self.file) or {self.key: {}})[self.key]
        return found

    def complete(self, set_ups: Iterable[SomeSetUp] | None = None, seconds: float = math.inf) -> Completed:
        """Solves those of the set-ups, all chosen ones if none are given, that have no record, and begins none after these seconds. Drops the
        records of what is none of them. Each record is written at once."""
        asked, known = list(self.chosen() if set_ups is None else set_ups), self.records()
        records = {each.identity: known[each.identity] for each in asked if each.identity in known}
        solved, end = 0, time.monotonic() + seconds
        for each in asked:
            if each.identity in records or time.monotonic() >= end:
                continue
            before = time.monotonic()
            try:
                records[each.identity] = self.solve(each)
            except NoAnswer as reason:
                print(f"{each.name}: {reason}", file=sys.stderr, flush=True)
                continue
            self.write(records)
            solved += 1
            print(f"{each.name}: {time.monotonic() - before:.0f} s", file=sys.stderr, flush=True)
        if records.keys() != known.keys():
            self.write(records)
        return Completed(solved, sum(each.identity not in records for each in asked))

    def write(self, records: Document) -> None:
        """Replaces the records."""
        write_json(self.file, {"description": self.description, self.key: records})


def rounded(record: Document) -> Document:
    """Returns a record with its numbers rounded."""
    return {key: _rounded(value) for key, value in record.items()}


def _rounded(value: Any) -> Any:
    if isinstance(value, dict):
        return rounded(value)
    if isinstance(value, list):
        return [_rounded(each) for each in value]
    return float(f"{value:.{_DIGITS}g}") if isinstance(value, float) else value


QUANTITIES = ("value", "background", "change")


@dataclass(frozen=True)
class Comparison(Generic[SomeSetUp]):
    """One quantity of a set-up's reading by both methods (F), and the ends of the interval that the field solver proves, if it does."""

    set_up: SomeSetUp
    quantity: str
    field: Estimate
    boundary: Estimate
    proven: tuple[float, float] = (float("-inf"), float("inf"))

    @property
    def difference(self) -> float:
        """Boundary elements less the field solver, relative to the field solver's value."""
        return self.boundary.value / self.field.value - 1

    @property
    def allowed(self) -> float:
        """The sum of both errors, relative to the field solver's value."""
        return (self.boundary.error + self.field.error) / abs(self.field.value)

    @property
    def over_errors(self) -> float:
        """The difference over what both errors allow: above 1 one of the values, or its error, is wrong."""
        return abs(self.difference) / self.allowed

    @property
    def is_proven(self) -> bool:
        """Whether the field solver proves an interval."""
        return self.proven[1] < float("inf")

    @property
    def half_width(self) -> float:
        """Half the width of the proven interval, relative to the field solver's value."""
        lower, upper = self.proven
        return (upper - lower) / 2 / abs(self.field.value)

    @property
    def is_enclosed(self) -> bool:
        """Whether the value by boundary elements lies within the proven interval."""
        lower, upper = self.proven
        return lower <= self.boundary.value <= upper


@dataclass(frozen=True, kw_only=True)
class FieldCheck(Stored[SomeSetUp]):
    """Records of the field solver's `quantities` of readings. A record has them by itself, or, with `both`, under "field" beside those by boundary elements
    under "boundary"; it may have "lower" and "upper", the ends of the interval proven for the change. A page counts the set-ups of each `kind`,
    has the columns `described` of them in its table, and an `explanation`."""

    kind: Callable[[SomeSetUp], str]
    described: tuple[tuple[str, Callable[[SomeSetUp], str]], ...]
    explanation: str = ""
    quantities: tuple[str, ...] = QUANTITIES
    both: bool = False

    def comparisons(self, found: Iterable[Any] = ()) -> list[Comparison[SomeSetUp]]:
        """Pairs the quantities that are recorded with those of the entries, which have a `set_up` and the quantities, in their order, or with those
        in the records."""
        records, pairs = self.records(), [(each.set_up, each) for each in found]
        if self.both:
            pairs = [(each, None) for each in self.chosen()]
        return [
            self._comparison(set_up, quantity, records[set_up.identity], entry)
            for set_up, entry in pairs
            if set_up.identity in records
            for quantity in self.quantities
        ]

    def _comparison(self, set_up: Any, quantity: str, record: Document, entry: Any) -> Comparison[SomeSetUp]:
        by_field = record["field"] if self.both else record
        boundary = Estimate(**record["boundary"][quantity]) if self.both else getattr(entry, quantity)
        proven = record.get("lower", -math.inf), record.get("upper", math.inf)
        return Comparison(set_up, quantity, Estimate(**by_field[quantity]), boundary, proven)


def solved(set_up: OfScene, *options: str) -> tuple[Document, Document]:
    """Solves a set-up by the field solver with these options of its command; returns its one reading and the whole answer. NoAnswer if it has none."""
    with temporary_folder() as folder:
        scene = folder / SCENE
        write_text(scene, set_up.text)
        document = reference_stage.solve(scene, Processes(), *options)
    (reading,) = document["readings"]
    return reading, document


def quantities_of(reading: Document, names: Iterable[str] = QUANTITIES) -> Document:
    """Returns quantities of a reading as a record has them."""
    return {name: {"value": reading[name], "error": reading["error"][name]} for name in names}


def by_boundary_elements(scene: Any, name: str, rtol: float) -> Document:
    """Solves a scene of the model's module for a reading; returns its quantities as a record has them."""
    reading = scene.readings("boundary-elements", rtol=rtol)[name]
    return quantities_of({"error": reading.error} | {each: getattr(reading, each) for each in QUANTITIES})


TITLE = "Checked by the field solver"
ABSENT = "None of these set-ups has a reading by the field solver."
GOAL = 5e-3
"""Largest difference of the methods, relative to the field solver's value, that there should be."""
Column = tuple[str, Callable[[Comparison[Any]], str]]
_PERCENT = 100.0
_BARS = (
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
        page.soft(f"{_BARS} {check.explanation}".strip()),
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
    near = sum(abs(each.difference) <= GOAL for each in own)
    return (
        f"{quantity} {sum(each.over_errors <= 1 for each in own)} of {len(own)} within the errors and {near} within {percent(GOAL)}, at most {worst:.2f} of the errors and "
        f"{signed_percent(farthest)} of the value"
    )


def _differences(check: FieldCheck[Any], found: list[Comparison[Any]]) -> Panel:
    """Plots the differences over the size of the value: a colour for each quantity, or of a single one for each kind of set-up."""
    is_one = len(check.quantities) == 1
    groups = grouped(found, lambda each: check.kind(each.set_up) if is_one else each.quantity)
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
    def ends(each: Comparison[Any]) -> str:
        return " and ".join(f"{end / PICOFARAD:.4g}" for end in each.proven)

    def of_set_up(shown: Callable[[Any], str]) -> Callable[[Comparison[Any]], str]:
        return lambda each: shown(each.set_up)

    within = ("within", lambda each: page.yes_or_no(each.is_enclosed))
    columns: list[Column] = [
        *((title, of_set_up(shown)) for title, shown in check.described),
        ("quantity", lambda each: each.quantity),
        ("field solver (pF)", lambda each: each.field.in_picofarads),
        ("boundary elements (pF)", lambda each: each.boundary.in_picofarads),
        ("difference", lambda each: signed_percent(each.difference)),
        ("errors", lambda each: percent(each.allowed)),
        ("difference/errors", lambda each: f"{each.over_errors:.2f}"),
        *([("proven to lie between (pF)", ends), within] if found[0].is_proven else []),
    ]
    return page.table_of(found, *columns, text_columns=len(check.described) + 1)
