"""The gate between two golden files: the same answers pass, each planted change fails by its own rule."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from analysis.golden.gate import Comparison, Recorded, compared
from analysis.honesty.methods import ANSWERED, ENDED, REFUSED, Answer, Stated
from analysis.results.answers import Estimate

NAME, CHANGE, FREE = "machines/one/reduced:1e-2", "reading: change", "C[sensor, hand]"
TRUE = Estimate(1.02e-12, 0.0)


def recorded(**more: Any) -> Recorded:
    """A change that holds its truth, and a quantity that states no error."""
    change = Stated(more.pop("value", 1e-12), more.pop("error", 3e-14), "reduced")
    values = {CHANGE: change, FREE: Stated(more.pop("free", 2e-12), None, "formula")}
    return Recorded("reduced:1e-2", Answer(ANSWERED, 1.0, values=values, reached=True), {CHANGE: TRUE})


def judged(new: Recorded, with_times: bool = True) -> Comparison:
    return compared({NAME: recorded()}, {NAME: new}, with_times)


def test_the_same_answers_pass_and_nothing_moved() -> None:
    found = judged(recorded())
    assert not found.faults and not found.moved and "passes" in found.text
    (row,) = found.rows.values()
    assert (row.cases, row.quantities, row.truths, row.held, row.time_ratio) == (1, 2, 1, [1, 1], 1.0)


def test_what_stays_within_all_bounds_passes_and_is_told() -> None:
    found = judged(recorded(value=1.04e-12, error=3.2e-14, free=2e-12 * (1 + 1e-12)))
    assert not found.faults
    assert [line.partition(": ")[0] for _, line in found.moved] == [NAME, NAME]
    (row,) = found.rows.values()
    assert (row.moved, row.largest_part) == (2, pytest.approx(0.04 / 1.04))
    assert (row.largest_move, row.largest_stated) == (pytest.approx(4 / 6.2), pytest.approx(3.2 / 3))
    assert "Moved: 2 quantities" in found.text


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"value": 1.07e-12, "error": 3.1e-14}, "farther than both errors"),
        ({"error": 3.4e-14}, "1.1 times the error"),
        ({"error": None}, "states no error any more"),
        ({"value": None}, "no value any more"),
        ({"error": 1e-14}, "0 truths within the stated error, 1 before"),
        ({"free": 2e-12 * (1 + 1e-6)}, "farther than both errors"),
    ],
)
def test_a_planted_change_fails(change: dict[str, float | None], word: str) -> None:
    found = judged(recorded(**change))
    assert any(word in fault for fault in found.faults)
    assert word in found.text and "fails" in found.text


def test_an_answer_that_is_gone_or_not_as_accurate_fails() -> None:
    for outcome in (REFUSED, ENDED):
        gone = replace(recorded(), answer=Answer(outcome, 1.0, "why"))
        assert f"{NAME}: was answered, is {outcome}: why" in judged(gone).faults
    short = recorded()
    short = replace(short, answer=replace(short.answer, reached=False))
    assert judged(short).faults == [f"{NAME}: no longer reaches what was asked"]


def test_an_answer_in_place_of_a_refusal_passes() -> None:
    before = replace(recorded(), answer=Answer(REFUSED, 1.0, "why"))
    assert not compared({NAME: before}, {NAME: recorded()}, with_times=True).faults


def test_more_time_warns_and_fails_only_if_asked() -> None:
    slow = recorded()
    slow = replace(slow, answer=replace(slow.answer, seconds=1.2))
    words = "reduced:1e-2: takes 1.20 times the time"
    assert judged(slow, with_times=False).warnings == [words] and not judged(slow, with_times=False).faults
    assert judged(slow, with_times=True).faults == [words]
