"""The table of the league: per method and kind how often stated errors held, and what missed the target worst."""

from __future__ import annotations

import math
import statistics
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from analysis.honesty.judging import Judged, Record, judged
from analysis.honesty.methods import ANSWERED, ENDED, LATE, REFUSED
from analysis.results.refusals import without_numbers
from geometries.common.measured import picofarads

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
        known = bool(self.judged)
        return (
            self.method,
            self.kind,
            str(self.scenes),
            str(self.answers),
            str(len(self.judged)),
            f"{100 * self.held:.1f} %" if known else "",
            _number(self.worst) if known else "",
            _number(statistics.median(widths)) if widths else "",
            str(self.unknown),
            *(str(self.outcomes[outcome]) for outcome in (REFUSED, LATE, ENDED)),
            f"{100 * self.guessed:.0f} %" if self.guesses else "",
            "missed" if self.misses_target else "",
        )


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
    lines = [_line(_HEADER), _line(("---",) * len(_HEADER))]
    lines += [_line(row.cells()) for row in found]
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
    lines = [
        f"Errors larger than stated: {len(wrong)}. The worst ones, in pF, {command} SEED shows a scene:",
        "",
    ]
    seen: Counter[tuple[str, str]] = Counter()
    for each in sorted(wrong, key=lambda each: -each.ratio):
        seen[each.method, each.kind] += 1
        if seen[each.method, each.kind] <= _MOST_OF_ONE and len(lines) < _MOST_FINDINGS + 2:
            lines.append(f"* {finding(each)}")
    return lines


def finding(each: Judged) -> str:
    """Returns one judged answer in a line."""
    by = f" by {each.answered_by}" if each.answered_by not in ("", each.method) else ""
    known = picofarads(each.reference.value, each.reference.error)
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


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _number(value: float) -> str:
    return "∞" if math.isinf(value) else f"{value:.3g}" if value < 100 else f"{value:.0f}"
