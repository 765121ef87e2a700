"""The gate between two golden files: what moved from the old one to the new one, and what must not have."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from analysis.honesty.methods import ANSWERED, Answer, Stated
from analysis.results.answers import Estimate
from geometries.common.measured import picofarads

MOST_WIDER, MOST_SLOWER = 1.1, 1.1
"""Largest ratio of a new stated error to the old one, and of the new times of a method to the old ones."""
_ROUNDING = 1e-9
"""What another order of operations may alter, relative to the value: the bound on what states no error."""
_MOST_MOVED = 20
_HEADER = "| method | cases | quantities | moved | by % at most | by errors | stated ratio | truths held, old | new | of | time ratio |"


@dataclass(frozen=True)
class Recorded:
    """A case of a golden file: its answer, whose key stands for what was asked, and what is known of it (F)."""

    method: str
    answer: Answer
    truths: dict[str, Estimate]

    @property
    def held(self) -> int:
        """How many truths lie within the stated error, their own allowed for."""
        return sum(
            each.error is not None and Estimate(each.value, each.error).agrees_with(self.truths[name])
            for name, each in self.answer.values.items()
            if name in self.truths and each.value is not None
        )


@dataclass
class Row:
    """What became of a method's cases. The largest move is given relative to the value and to both stated errors, which may be wide; `held` and
    `seconds` are of the old file and the new."""

    cases: int = 0
    quantities: int = 0
    moved: int = 0
    largest_part: float = 0.0
    largest_move: float = 0.0
    largest_stated: float = 0.0
    truths: int = 0
    held: list[int] = field(default_factory=lambda: [0, 0])
    seconds: list[float] = field(default_factory=lambda: [0.0, 0.0])

    @property
    def time_ratio(self) -> float:
        return self.seconds[1] / self.seconds[0] if self.seconds[0] > 0 else 1.0


@dataclass
class Comparison:
    """Rows by their methods; `moved` has the size of a move and its line, `faults` are what the gate does not let through."""

    rows: dict[str, Row] = field(default_factory=dict)
    moved: list[tuple[float, str]] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    @property
    def text(self) -> str:
        """The table, the largest moves, warnings, faults and the verdict."""
        lines = [_HEADER, _HEADER.count(" | ") * "|---" + "|---|"]
        lines += [
            f"| {name} | {row.cases} | {row.quantities} | {row.moved} | {100 * row.largest_part:.2g} | {row.largest_move:.2g} | {row.largest_stated:.3g} "
            f"| {row.held[0]} | {row.held[1]} | {row.truths} | {row.time_ratio:.2f} |"
            for name, row in self.rows.items()
        ]
        if self.moved:
            lines += ["", f"Moved: {len(self.moved)} quantities; the largest moves, in pF:"]
            lines += [f"* {line}" for _, line in sorted(self.moved, reverse=True)[:_MOST_MOVED]]
        lines += [f"warning: {line}" for line in self.warnings]
        lines += [f"fault: {line}" for line in self.faults]
        verdict = f"fails, faults: {len(self.faults)}" if self.faults else "passes"
        return "\n".join([*lines, f"The gate {verdict}."]) + "\n"


def compared(old: dict[str, Recorded], new: dict[str, Recorded], with_times: bool) -> Comparison:
    """Compares the same cases of two files; more time is a fault, not only a warning, with `with_times`."""
    found = Comparison()
    for name, after in new.items():
        was, now = old[name].answer, after.answer
        row = found.rows.setdefault(after.method, Row())
        row.cases += 1
        row.truths += len(after.truths.keys() & now.values.keys())
        row.held = [row.held[0] + old[name].held, row.held[1] + after.held]
        if was.outcome == ANSWERED and now.outcome != ANSWERED:
            found.faults.append(f"{name}: was answered, is {now.outcome}{now.reason and f': {now.reason}'}")
        elif was.outcome == ANSWERED:
            row.seconds = [row.seconds[0] + was.seconds, row.seconds[1] + now.seconds]
            for quantity, stated in was.values.items():
                _compare(found, row, f"{name}: {quantity}", stated, now.values.get(quantity))
        if was.reached and not now.reached:
            found.faults.append(f"{name}: no longer reaches what was asked")
    for method, row in found.rows.items():
        if row.held[1] < row.held[0]:
            found.faults.append(
                f"{method}: {row.held[1]} truths within the stated error, {row.held[0]} before"
            )
        if row.time_ratio > MOST_SLOWER:
            slow = found.faults if with_times else found.warnings
            slow.append(f"{method}: takes {row.time_ratio:.2f} times the time")
    return found


def _compare(found: Comparison, row: Row, name: str, was: Stated, now: Stated | None) -> None:
    """Adds what became of one quantity."""
    row.quantities += 1
    if was.value is None:
        return
    if now is None or now.value is None:
        found.faults.append(f"{name}: has no value any more")
        return
    rounding = _ROUNDING * abs(was.value)
    difference, allowed = abs(now.value - was.value), (was.error or 0.0) + (now.error or 0.0)
    move = difference / allowed if allowed > 0 else math.inf if difference > rounding else 0.0
    words = [
        picofarads(value, error or 0.0) for value, error in ((was.value, was.error), (now.value, now.error))
    ]
    line = f"{name}: {' → '.join(words)}"
    if difference > 0:
        row.moved += 1
        row.largest_part = max(row.largest_part, difference / max(abs(was.value), abs(now.value)))
        row.largest_move = max(row.largest_move, move)
        found.moved.append((move, f"{line}, {move:.2g} of both errors"))
    if difference > allowed + rounding:
        found.faults.append(f"{line}: farther than both errors")
    if was.error is not None and now.error is None:
        found.faults.append(f"{line}: states no error any more")
    elif was.error and now.error is not None:
        row.largest_stated = max(row.largest_stated, now.error / was.error)
        if now.error > MOST_WIDER * was.error + rounding:
            found.faults.append(f"{line}: states more than {MOST_WIDER:g} times the error")
