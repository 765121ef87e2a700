"""What is marked in the values of many commits: a change beyond errors, a drift, more instructions; and what is held back."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from analysis.topics.trends import changes, records
from analysis.topics.trends.changes import DRIFTED, FASTER, MOVED, SLOWER
from analysis.topics.trends.records import Record

COMMITS = 12


def nights(
    values: list[float], error: float = 0.1, kind: str = "field solver", name: str = "a"
) -> list[Record]:
    """One value over so many commits, on one machine."""
    return [
        Record(kind, name, "", value, error, 10.0, processor="old", commit=f"c{at}", time=f"{at:04}")
        for at, value in enumerate(values)
    ]


def told(found: list[Record]) -> list[tuple[str, str, str]]:
    return [(mark.after.name, mark.after.commit, mark.what) for mark in changes.marks(found) if mark.is_alarm]


def test_one_regression_among_many_values_is_found_at_its_commit() -> None:
    steady = [each for n in range(20) for each in nights([2.0] * COMMITS, name=f"steady {n}")]
    regressed = nights([2.0] * 7 + [2.3] * (COMMITS - 7), name="regressed")
    assert told(steady + regressed) == [("regressed", "c7", MOVED)]
    (mark,) = changes.marks(steady + regressed)
    assert (
        mark.before.commit == "c6"
        and mark.over == pytest.approx(1.5)
        and mark.relative == pytest.approx(0.15)
    )


@pytest.mark.parametrize(
    ("after", "error", "moved"),
    [(2.19, 0.1, False), (2.21, 0.1, True), (2.31, 0.3, False), (math.nan, 0.1, True)],
)
def test_a_value_moves_when_it_changes_by_more_than_both_errors(
    after: float, error: float, moved: bool
) -> None:
    before, last = nights([2.0, after])
    assert bool(told([before, replace(last, error=error)])) == moved


def test_a_value_that_stays_unknown_has_not_moved() -> None:
    assert not told(nights([math.nan, math.nan]))


def test_a_mean_that_drifts_in_steps_within_the_errors_is_found_once() -> None:
    drifting = nights([2.0 + 0.03 * at for at in range(COMMITS)])
    assert told(drifting) == [("a", "c10", DRIFTED)]
    assert not told(nights([2.0 + 0.05 * (-1) ** at for at in range(COMMITS)]))


def test_more_instructions_alarm_and_fewer_do_not() -> None:
    counted = nights([1000.0] * 5 + [1040.0] * 5 + [900.0] * 2, error=5.0, kind=records.INSTRUCTIONS)
    assert told(counted) == [("a", "c5", SLOWER)]
    assert [mark.what for mark in changes.marks(counted)] == [SLOWER, FASTER]


def test_longer_times_are_never_told() -> None:
    first, *rest = nights([2.0] * COMMITS)
    assert not changes.marks([first, *(replace(each, seconds=1e4) for each in rest)])


def on_another_machine(found: list[Record], **new: str) -> list[Record]:
    """The same from the sixth commit on another machine."""
    return [replace(each, **new) if each.time >= "0006" else each for each in found]  # type: ignore[arg-type]


@pytest.mark.parametrize("new", [{"processor": "new"}, {"versions": "dolfinx 2"}])
def test_alarms_are_held_back_where_most_values_moved_on_another_machine(new: dict[str, str]) -> None:
    moving = [each for n in range(4) for each in nights([2.0] * 6 + [2.5] * 6, name=f"moving {n}")]
    steady = nights([2.0] * COMMITS, name="steady")
    held = on_another_machine(moving + steady, **new)
    assert not told(held) and sum(mark.held for mark in changes.marks(held)) == 4
    assert len(told(moving + steady)) == 4
    text = changes.to_text(changes.marks(held))
    assert text == "0 values moved by more than their errors; 4 more on another machine, where most did\n"


def test_few_values_that_move_on_another_machine_are_told_and_so_is_what_moves_later() -> None:
    moving = nights([2.0] * 6 + [2.5] * 3 + [3.0] * 3, name="moving")
    steady = [each for n in range(4) for each in nights([2.0] * COMMITS, name=f"steady {n}")]
    assert told(on_another_machine(moving + steady, processor="new")) == [
        ("moving", "c6", MOVED),
        ("moving", "c9", MOVED),
    ]


def test_another_method_that_moved_holds_nothing_back() -> None:
    others = [
        each for n in range(4) for each in nights([2.0] * 6 + [2.5] * 6, kind="model exact", name=f"{n}")
    ]
    own = nights([2.0] * 6 + [2.5] * 6, name="own") + [
        each for n in range(4) for each in nights([2.0] * COMMITS, name=f"steady {n}")
    ]
    assert told(on_another_machine(others + own, processor="new")) == [("own", "c6", MOVED)]
