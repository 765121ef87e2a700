"""Records of scenes with all answers, one line of JSON each, how stated errors are held against independent references, and the league's table: per
method and kind how often they held, and what missed the target worst."""

import json
import math
import statistics
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from analysis.honesty.asking import ANSWERED, ENDED, FIELD_SOLVER, FINER, LATE, REFUSED, Answer, Stated
from analysis.results.answers import Estimate
from analysis.results.refusals import without_numbers
from analysis.results.store import markdown_table
from geometries.common.measured import picofarads

FILE = "answers.jsonl"


@dataclass
class Record:
    """A scene by its seed and kind, what is known of it in closed form, and its answers by their methods."""

    seed: int
    kind: str
    truths: dict[str, Estimate]
    answers: dict[str, Answer] = field(default_factory=dict)


def load(folder: Path) -> dict[int, Record]:
    """Returns the records of a folder by their seeds: of several of one scene all answers, the last one of each method. A line that was
    not finished is left out."""
    found: dict[int, Record] = {}
    file = folder / FILE
    for line in file.read_text(encoding="utf-8").splitlines() if file.is_file() else []:
        try:
            read = json.loads(line)
            answers = {name: answer(each) for name, each in read["answers"].items()}
            record = Record(read["seed"], read["kind"], estimates(read["truths"]), answers)
        except (ValueError, KeyError, TypeError):
            continue
        before = found.setdefault(record.seed, record)
        before.answers |= record.answers
    return found


def append(folder: Path, record: Record) -> None:
    """Adds a record to those of a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / FILE).open("a", encoding="utf-8") as file:
        file.write(json.dumps(asdict(record)) + "\n")


def estimates(documents: dict[str, Any]) -> dict[str, Estimate]:
    """Reads stored truths."""
    return {name: Estimate(**known) for name, known in documents.items()}


def answer(document: dict[str, Any]) -> Answer:
    """Reads a stored answer."""
    values = {name: Stated(**stated) for name, stated in document["values"].items()}
    return replace(Answer(**document), values=values)


CLOSED_FORM, ITSELF = "closed form", "itself, finer"
_ENOUGH = 0.5
"""Largest error of a reference, relative to the error stated, by which this may be judged."""
_SMALL = 0.1
"""The same for how much too wide it is."""
_ROUNDING = 1e-12
"""Relative error of any number."""
_SAME = "boundary-elements"
"""What the finer answer has in common with the methods that it is not independent of."""


@dataclass(frozen=True)
class Judged:
    """An answer beside its reference (F)."""

    seed: int
    kind: str
    method: str
    quantity: str
    value: float
    stated: float
    answered_by: str
    reference: Estimate
    by: str

    @property
    def difference(self) -> float:
        return abs(self.value - self.reference.value)

    @property
    def ratio(self) -> float:
        """By how much the error is larger than stated, after what the reference itself may be off; at most 1 where it held."""
        error = max(0.0, self.difference - self.reference.error)
        if self.stated > 0:
            return error / self.stated
        return math.inf if error > 0 else 0.0

    @property
    def is_held(self) -> bool:
        return self.ratio <= 1

    @property
    def width(self) -> float | None:
        """How many times as large the stated error is as the true one, at least; None where the reference cannot tell."""
        least = max(self.difference, self.reference.error)
        if self.reference.error > _SMALL * self.stated or least == 0:
            return None
        return self.stated / least


@dataclass(frozen=True)
class Unjudged:
    """An answer that no reference is accurate enough to judge, or, with `is_unknown`, that states no error."""

    kind: str
    method: str
    is_unknown: bool


def judged(record: Record, method: str) -> Iterator[Judged | Unjudged]:
    """Returns what becomes of each quantity of a method's answer. One that the method does not know by its nature, as the formula knows
    only changes, is left out."""
    for quantity, stated in record.answers[method].values.items():
        if stated.value is None and not quantity.endswith(("change", "]")):
            continue
        if stated.value is None or stated.error is None:
            yield Unjudged(record.kind, method, True)
            continue
        yield _judged(record, method, quantity, stated, stated.value, stated.error)


def _judged(
    record: Record, method: str, quantity: str, answer: Stated, value: float, stated: float
) -> Judged | Unjudged:
    beside = [
        Judged(record.seed, record.kind, method, quantity, value, stated, answer.by, known, by)
        for by, known in _references(record, method, quantity, answer.by)
    ]
    accurate = [each for each in beside if each.reference.error <= _ENOUGH * stated]
    # An answer that contradicts a reference by more than both errors is wrong, however wide the reference is.
    wrong = [each for each in beside if not each.is_held]
    return next(iter(accurate + wrong), Unjudged(record.kind, method, False))


def _references(record: Record, method: str, quantity: str, by: str) -> Iterator[tuple[str, Estimate]]:
    """Returns what is known of a quantity, the most independent first."""
    if quantity in record.truths:
        yield CLOSED_FORM, _rounded(record.truths[quantity])
    if method != FIELD_SOLVER and (known := _estimate(record.answers.get(FIELD_SOLVER), quantity)):
        yield FIELD_SOLVER, known
    if known := _estimate(record.answers.get(FINER), quantity):
        yield ITSELF if _SAME in f"{method} {by}" else FINER, known


def _estimate(answer: Answer | None, quantity: str) -> Estimate | None:
    stated = answer.values.get(quantity) if answer is not None else None
    if stated is None or stated.value is None or stated.error is None:
        return None
    return _rounded(Estimate(stated.value, stated.error))


def _rounded(known: Estimate) -> Estimate:
    return Estimate(known.value, known.error + _ROUNDING * abs(known.value))


LEAST_HELD, MOST_EXCEEDED = 0.95, 3.0
"""The target, for each method and kind: the part of the stated errors that hold, and the most that one is exceeded by."""
_EVERY_KIND = "all"
_MOST_FINDINGS, _MOST_OF_ONE = 30, 3
_HEADER = (
    "method", "kind", "scenes", "answers", "judged", "held", "worst", "width", "unknown", "refused", "late", "ended", "guessed", "",
)  # fmt: skip


@dataclass
class Row:
    """What became of one method's answers to the scenes of one kind. Scenes are refused, late or ended, each of the other counts is of
    quantities."""

    method: str
    kind: str
    scenes: int = 0
    answers: int = 0
    unknown: int = 0
    outcomes: Counter[str] = field(default_factory=Counter)
    reasons: Counter[str] = field(default_factory=Counter)
    judged: list[Judged] = field(default_factory=list)
    guesses: list[float] = field(default_factory=list)

    @property
    def held(self) -> float:
        """The part of the judged errors that held."""
        return sum(each.is_held for each in self.judged) / len(self.judged)

    @property
    def worst(self) -> float:
        return max(each.ratio for each in self.judged)

    @property
    def guessed(self) -> float:
        """The part of the answers that took as long as was expected, within a factor of two."""
        return sum(1 / 2 <= guess <= 2 for guess in self.guesses) / len(self.guesses)

    @property
    def misses_target(self) -> bool:
        """Whether a process ended, or stated errors held too seldom or were exceeded by too much."""
        if self.outcomes[ENDED]:
            return True
        return bool(self.judged) and (self.held < LEAST_HELD or self.worst > MOST_EXCEEDED)

    def add(self, record: Record) -> None:
        answer = record.answers[self.method]
        self.scenes += 1
        self.outcomes[answer.outcome] += 1
        if answer.outcome != ANSWERED and answer.reason:
            self.reasons[without_numbers(answer.reason)] += 1
        if answer.guess is not None:
            self.guesses.append(answer.guess)
        for each in judged(record, self.method):
            self.answers += 1
            if isinstance(each, Judged):
                self.judged.append(each)
            else:
                self.unknown += each.is_unknown

    def cells(self) -> tuple[str, ...]:
        widths = [each.width for each in self.judged if each.width is not None]
        counts = map(str, (self.scenes, self.answers, len(self.judged)))
        held = (f"{100 * self.held:.1f} %", _number(self.worst)) if self.judged else ("", "")
        width = _number(statistics.median(widths)) if widths else ""
        without = map(str, (self.unknown, *(self.outcomes[outcome] for outcome in (REFUSED, LATE, ENDED))))
        guessed = f"{100 * self.guessed:.0f} %" if self.guesses else ""
        missed = "missed" if self.misses_target else ""
        return (self.method, self.kind, *counts, *held, width, *without, guessed, missed)


def rows(records: Iterable[Record], methods: Sequence[str]) -> list[Row]:
    """Returns a row for each method and kind of the records, and one for each method over all kinds."""
    found: dict[tuple[str, str], Row] = {}
    for record in records:
        for method in record.answers:
            if method in methods:
                for kind in (record.kind, _EVERY_KIND):
                    found.setdefault((method, kind), Row(method, kind)).add(record)
    order = {method: number for number, method in enumerate(methods)}
    return sorted(found.values(), key=lambda row: (order[row.method], row.kind == _EVERY_KIND))


def misses(found: Iterable[Row]) -> list[Row]:
    """Returns the rows of single kinds that miss the target."""
    return [row for row in found if row.kind != _EVERY_KIND and row.misses_target]


def text(found: Sequence[Row], command: str) -> str:
    """Returns table, refusals and worst findings as Markdown; `command` shows one scene, if followed by its seed."""
    lines = markdown_table(_HEADER, [row.cells() for row in found])
    lines += ["", *_refusals(found), "", *_findings(found, command), "", _verdict(found)]
    return "\n".join(lines) + "\n"


def _refusals(found: Sequence[Row]) -> list[str]:
    lines = ["Most frequent reasons without an answer:", ""]
    for row in found:
        if row.kind == _EVERY_KIND:
            lines += [f"* {row.method}, {count}: {reason}" for reason, count in row.reasons.most_common(3)]
    return lines


def _findings(found: Sequence[Row], command: str) -> list[str]:
    wrong = [each for row in found if row.kind != _EVERY_KIND for each in row.judged if not each.is_held]
    worst = f"The worst ones, in pF, {command} SEED shows a scene:"
    lines = [f"Errors larger than stated: {len(wrong)}. {worst}", ""]
    seen: Counter[tuple[str, str]] = Counter()
    for each in sorted(wrong, key=lambda each: -each.ratio):
        seen[each.method, each.kind] += 1
        if seen[each.method, each.kind] <= _MOST_OF_ONE and len(lines) < _MOST_FINDINGS + 2:
            lines.append(f"* {finding(each)}")
    return lines


def finding(each: Judged) -> str:
    """Returns one judged answer in a line."""
    by = f" by {each.answered_by}" if each.answered_by not in ("", each.method) else ""
    known = each.reference.in_picofarads
    return (
        f"seed {each.seed}, {each.kind}, {each.method}{by}: {each.quantity} {picofarads(each.value, each.stated)}, "
        f"{each.by} {known}: {_number(each.ratio)} times what is stated"
    )


def _verdict(found: Sequence[Row]) -> str:
    missed = misses(found)
    target = f"at least {100 * LEAST_HELD:.0f} % held and none exceeded by more than {MOST_EXCEEDED:g} times"
    if not missed:
        return f"The target is met for each method and kind: {target}."
    return f"The target, {target}, is missed by {len(missed)} of {sum(row.kind != _EVERY_KIND for row in found)} methods and kinds."


def _number(value: float) -> str:
    return "∞" if math.isinf(value) else f"{value:.3g}" if value < 100 else f"{value:.0f}"
