"""How stated errors are judged, on answers that are made up."""

from __future__ import annotations

import math

import pytest

from analysis.honesty import table
from analysis.honesty.judging import CLOSED_FORM, ITSELF, Judged, Record, Unjudged, judged
from analysis.honesty.methods import ANSWERED, ENDED, FIELD_SOLVER, FINER, LATE, REFUSED, Answer, Stated
from analysis.results.answers import Estimate

CHANGE, VALUE = "front: change", "front: value"


def record(
    value: float | None,
    error: float | None,
    method: str = "formula",
    truth: tuple[float, float] | None = None,
    field: tuple[float, float] | None = None,
    finer: tuple[float, float] | None = None,
    quantity: str = CHANGE,
    by: str = "",
) -> Record:
    """One answer, in F, and what it is held against."""
    answers = {method: Answer(ANSWERED, 1.0, values={quantity: Stated(value, error, by)})}
    for name, known in ((FIELD_SOLVER, field), (FINER, finer)):
        if known is not None:
            answers[name] = Answer(ANSWERED, 1.0, values={quantity: Stated(*known)})
    return Record(7, "plates", {quantity: Estimate(*truth)} if truth else {}, answers)


def only(made: Record, method: str = "formula") -> Judged | Unjudged:
    (found,) = judged(made, method)
    return found


def test_an_error_holds_that_is_at_least_the_true_one() -> None:
    found = only(record(1.0, 0.1, truth=(1.05, 0.0)))
    assert isinstance(found, Judged)
    assert found.by == CLOSED_FORM and found.is_held
    assert found.ratio == pytest.approx(0.5) and found.width == pytest.approx(2)


def test_the_error_of_the_reference_is_forgiven() -> None:
    found = only(record(1.0, 0.1, truth=(1.22, 0.02)))
    assert isinstance(found, Judged)
    assert found.ratio == pytest.approx(2) and not found.is_held


def test_a_reference_that_is_not_accurate_enough_judges_nothing_but_contradictions() -> None:
    assert only(record(1.0, 0.1, truth=(1.0, 0.09))) == Unjudged("plates", "formula", False)
    found = only(record(1.0, 0.1, truth=(1.5, 0.09)))
    assert isinstance(found, Judged) and found.ratio == pytest.approx(4.1)


def test_an_error_of_nothing_has_to_be_right() -> None:
    exact, wrong = (only(record(1.0, 0.0, truth=(truth, 0.0))) for truth in (1.0, 1.1))
    assert isinstance(wrong, Judged) and math.isinf(wrong.ratio)
    assert isinstance(exact, Unjudged)


def test_the_most_independent_reference_that_is_accurate_enough_judges() -> None:
    known = {"truth": (1.0, 0.0), "field": (1.01, 0.001), "finer": (1.02, 0.001)}
    by = []
    while known:
        found = only(record(1.0, 0.1, **known))  # type: ignore[arg-type]
        assert isinstance(found, Judged)
        by.append(found.by)
        known.pop(next(iter(known)))
    assert by == [CLOSED_FORM, FIELD_SOLVER, FINER]
    found = only(record(1.0, 0.1, field=(1.0, 0.08), finer=(1.0, 0.01)))
    assert isinstance(found, Judged) and found.by == FINER


@pytest.mark.parametrize(
    ("method", "by"), [("boundary-elements:1e-2", ""), ("auto:1e-2", "boundary-elements")]
)
def test_boundary_elements_that_judge_themselves_are_called_so(method: str, by: str) -> None:
    found = only(record(1.0, 0.1, method, finer=(1.0, 0.01), by=by), method)
    assert isinstance(found, Judged) and found.by == ITSELF


def test_the_field_solver_is_not_held_against_itself() -> None:
    assert isinstance(only(record(1.0, 0.1, FIELD_SOLVER), FIELD_SOLVER), Unjudged)


def test_what_is_not_known_is_no_answer_and_what_a_method_never_knows_is_nothing() -> None:
    unknown = Unjudged("plates", "formula", True)
    assert only(record(1.0, None, truth=(1.0, 0.0))) == unknown
    assert only(record(None, None, truth=(1.0, 0.0))) == unknown
    assert list(judged(record(None, None, quantity=VALUE), "formula")) == []


def test_rows_count_and_tell_what_misses_the_target() -> None:
    made = [record(1.0, 0.1, truth=(1.05, 0.0)) for _ in range(18)]
    (row, _) = table.rows(made, ["formula"])
    assert row.held == 1 and table.misses([row]) == []
    made += [record(1.0, 0.1, truth=(1.15, 0.0)) for _ in range(2)]
    (row, whole) = table.rows(made, ["formula"])
    assert row.held == pytest.approx(0.9) and row.worst == pytest.approx(1.5)
    assert table.misses([row, whole]) == [row]


def test_one_error_of_many_that_is_exceeded_too_much_misses_the_target() -> None:
    made = [record(1.0, 0.1, truth=(1.05, 0.0)) for _ in range(99)] + [record(1.0, 0.1, truth=(1.4, 0.0))]
    found = table.rows(made, ["formula"])
    assert table.misses(found) == [found[0]]
    text = table.text(found, "show")
    assert "| formula | plates | 100 | 100 | 100 | 99.0 % | 4 | 2 | 0 | 0 | 0 | 0 |  | missed |" in text
    assert "seed 7, plates, formula: front: change" in text and "is missed by 1 of 1" in text


def test_guesses_of_the_time_are_right_within_a_factor_of_two() -> None:
    guesses = (0.4, 0.6, 1.9, 2.1, None)
    made = [Record(k, "plates", {}, {"auto:1e-2": Answer(ANSWERED, guess=g)}) for k, g in enumerate(guesses)]
    found = table.rows(made, ["auto:1e-2"])
    assert found[0].guessed == 0.5 and "| 0 | 0 | 0 | 50 % |  |" in table.text(found, "show")


def test_refusals_are_told_with_their_most_frequent_reason() -> None:
    reasons = (REFUSED, "gap of 3 mm"), (REFUSED, "gap of 4 mm"), (REFUSED, "has a room"), (LATE, "")
    made = [
        Record(k, "plates", {}, {"formula": Answer(*outcome[:1], 1.0, outcome[1])})
        for k, outcome in enumerate(reasons)
    ]
    text = table.text(table.rows(made, ["formula"]), "show")
    assert "* formula, 2: gap of # mm" in text
    assert "| formula | plates | 4 | 0 | 0 |  |  |  | 0 | 3 | 1 | 0 |  |  |" in text
    assert "target is met" in text


def test_a_process_that_ends_misses_the_target() -> None:
    found = table.rows([Record(1, "plates", {}, {"formula": Answer(ENDED, 1.0, "signal 11")})], ["formula"])
    assert table.misses(found) == [found[0]]
