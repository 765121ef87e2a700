"""Finds what has changed in the values of many nights, and which of it is an alarm.

A value has moved where two records that follow each other differ by more than both their errors. It drifts where the mean of its
last four records and that of the first four since it last moved differ by as much, however small each step was. The same is told
of instruction counts; that fewer are needed is no alarm. Run times by the clock are never looked at.

On another machine, with another processor or other versions of packages, alarms are held back where most values of the same
method moved at once: it is the machine that they tell of.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, replace

from analysis.topics.trends.records import INSTRUCTIONS, Record

MOVED, DRIFTED, SLOWER, FASTER = "moved", "drifted", "more instructions", "fewer instructions"
# Records whose mean a drift is told by, and the fewest values of a method that most of them can be told by.
_WINDOW, _FEWEST = 4, 3
_MOST_LINES = 20


@dataclass(frozen=True)
class Mark:
    """A change from one record to another; `over` is its size relative to what the errors of both allow. `held` tells whether most
    comparable values moved on another machine."""

    what: str
    before: Record
    after: Record
    over: float
    held: bool = False

    @property
    def is_alarm(self) -> bool:
        return not self.held and self.what != FASTER

    @property
    def relative(self) -> float:
        """The change over the value before; infinite where that was zero or not finite."""
        change = self.after.value - self.before.value
        return change / abs(self.before.value) if self.before.value else math.copysign(math.inf, change)


Step = tuple[Record, Record]


def marks(records: Iterable[Record]) -> list[Mark]:
    """Returns all changes, in the order of the nights, those of a night the largest first."""
    found: list[Mark] = []
    steps: dict[tuple[str, str], list[Step]] = defaultdict(list)
    for own in by_series(records).values():
        found += _of_series(own)
        for before, after in zip(own, own[1:]):
            if before.machine != after.machine:
                steps[after.kind, after.time].append((before, after))
    held = {
        night
        for night, comparable in steps.items()
        if len(comparable) >= _FEWEST and 2 * sum(map(_has_moved, comparable)) > len(comparable)
    }
    return [
        replace(mark, held=mark.before.machine != mark.after.machine and _night(mark) in held)
        for mark in sorted(found, key=lambda mark: (mark.after.time, -mark.over))
    ]


def by_series(records: Iterable[Record]) -> dict[tuple[str, str], list[Record]]:
    """Returns the records of each value, in the order given."""
    found: dict[tuple[str, str], list[Record]] = defaultdict(list)
    for each in records:
        found[each.series].append(each)
    return found


def to_text(found: list[Mark]) -> str:
    """Writes alarms for people: a line that counts, and one for each of the largest."""
    alarms = [mark for mark in found if mark.is_alarm]
    held = sum(mark.held for mark in found)
    lines = [
        f"{len(alarms)} values moved by more than their errors"
        + (f"; {held} more on another machine, where most did" if held else "")
    ]
    for mark in alarms[:_MOST_LINES]:
        before, after = mark.before, mark.after
        lines.append(
            f"  {after.kind}: {after.name}: {mark.what}, {before.value:.7g} -> {after.value:.7g} ({mark.relative:+.2e}), "
            f"{mark.over:.3g} times what the errors allow"
        )
    more = [f"  … and {len(alarms) - _MOST_LINES} more"] if len(alarms) > _MOST_LINES else []
    return "\n".join(lines + more) + "\n"


def _of_series(own: list[Record]) -> list[Mark]:
    """Returns the changes of one value. After each, what was before counts no more."""
    found, since = [], own[:1]
    for before, after in zip(own, own[1:]):
        mark = None
        if _has_moved((before, after)):
            mark = _mark(MOVED, before, after, _over(before, after))
        else:
            since.append(after)
            if len(since) >= 2 * _WINDOW:
                over = _over(_mean(since[:_WINDOW]), _mean(since[-_WINDOW:]))
                mark = _mark(DRIFTED, since[0], after, over) if over > 1 else None
        if mark is not None:
            found.append(mark)
            since = [after]
    return found


def _mark(what: str, before: Record, after: Record, over: float) -> Mark:
    if after.kind == INSTRUCTIONS:
        what = SLOWER if after.value > before.value else FASTER
    return Mark(what, before, after, over)


def _mean(some: list[Record]) -> Record:
    value, error = (sum(parts) / len(some) for parts in ([r.value for r in some], [r.error for r in some]))
    return replace(some[-1], value=value, error=error)


def _has_moved(step: Step) -> bool:
    return _over(*step) > 1


def _over(before: Record, after: Record) -> float:
    """Returns the change relative to both errors; 0 for equal values, also if neither is finite, and infinity if only one is."""
    if before.value == after.value or (math.isnan(before.value) and math.isnan(after.value)):
        return 0.0
    change, error = abs(after.value - before.value), before.error + after.error
    if not math.isfinite(change):
        return math.inf
    return change / error if error > 0 else math.inf


def _night(mark: Mark) -> tuple[str, str]:
    return mark.after.kind, mark.after.time
