"""How stated errors are judged, on answers that are made up. Two small scenes asked in earnest, what is kept of them, and what the
command makes of its options."""

import math
import os
from pathlib import Path

import pytest

from analysis import __main__ as command_line
from analysis.honesty import judging, run
from analysis.honesty.asking import (
    ANSWERED,
    ENDED,
    FIELD_SOLVER,
    FINER,
    LATE,
    METHODS,
    REFUSED,
    Answer,
    Stated,
    Worker,
)
from analysis.honesty.judging import CLOSED_FORM, ITSELF, Judged, Record, Unjudged, judged
from analysis.honesty.kinds import KINDS, drawn
from analysis.results.answers import Estimate
from tests.programs import analysis, in_this_process

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


@pytest.mark.parametrize(
    ("error", "truth", "ratio", "width"),
    [
        pytest.param(0.1, (1.05, 0.0), 0.5, 2, id="it holds"),
        pytest.param(0.1, (1.22, 0.02), 2, None, id="the error of the reference is forgiven"),
        pytest.param(0.1, (1.5, 0.09), 4.1, None, id="a contradiction is judged by any reference"),
        pytest.param(0.0, (1.1, 0.0), math.inf, None, id="an error of nothing has to be right"),
    ],
)
def test_an_error_is_held_against_the_true_one(
    error: float, truth: tuple[float, float], ratio: float, width: float | None
) -> None:
    found = only(record(1.0, error, truth=truth))
    assert isinstance(found, Judged) and found.by == CLOSED_FORM
    assert found.ratio == pytest.approx(ratio) and found.is_held == (ratio <= 1)
    assert found.width == (None if width is None else pytest.approx(width))


@pytest.mark.parametrize(("error", "truth"), [(0.1, (1.0, 0.09)), (0.0, (1.0, 0.0))])
def test_a_reference_that_is_not_accurate_enough_judges_nothing(
    error: float, truth: tuple[float, float]
) -> None:
    assert only(record(1.0, error, truth=truth)) == Unjudged("plates", "formula", False)


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
    (row, _) = judging.rows(made, ["formula"])
    assert row.held == 1 and judging.misses([row]) == []
    made += [record(1.0, 0.1, truth=(1.15, 0.0)) for _ in range(2)]
    (row, whole) = judging.rows(made, ["formula"])
    assert row.held == pytest.approx(0.9) and row.worst == pytest.approx(1.5)
    assert judging.misses([row, whole]) == [row]


def test_one_error_of_many_that_is_exceeded_too_much_misses_the_target() -> None:
    made = [record(1.0, 0.1, truth=(1.05, 0.0)) for _ in range(99)] + [record(1.0, 0.1, truth=(1.4, 0.0))]
    found = judging.rows(made, ["formula"])
    assert judging.misses(found) == [found[0]]
    text = judging.text(found, "show")
    assert "| formula | plates | 100 | 100 | 100 | 99.0 % | 4 | 2 | 0 | 0 | 0 | 0 |  | missed |" in text
    assert "seed 7, plates, formula: front: change" in text and "is missed by 1 of 1" in text


def test_guesses_of_the_time_are_right_within_a_factor_of_two() -> None:
    guesses = (0.4, 0.6, 1.9, 2.1, None)
    made = [Record(k, "plates", {}, {"auto:1e-2": Answer(ANSWERED, guess=g)}) for k, g in enumerate(guesses)]
    found = judging.rows(made, ["auto:1e-2"])
    assert found[0].guessed == 0.5 and "| 0 | 0 | 0 | 50 % |  |" in judging.text(found, "show")


def test_refusals_are_told_with_their_most_frequent_reason() -> None:
    reasons = (REFUSED, "gap of 3 mm"), (REFUSED, "gap of 4 mm"), (REFUSED, "has a room"), (LATE, "")
    made = [
        Record(k, "plates", {}, {"formula": Answer(*outcome[:1], 1.0, outcome[1])})
        for k, outcome in enumerate(reasons)
    ]
    text = judging.text(judging.rows(made, ["formula"]), "show")
    assert "* formula, 2: gap of # mm" in text
    assert "| formula | plates | 4 | 0 | 0 |  |  |  | 0 | 3 | 1 | 0 |  |  |" in text
    assert "target is met" in text


def test_a_process_that_ends_misses_the_target() -> None:
    found = judging.rows([Record(1, "plates", {}, {"formula": Answer(ENDED, 1.0, "signal 11")})], ["formula"])
    assert judging.misses(found) == [found[0]]


QUICK = {"method": "reduced"}
PLATES = 0


def go_on() -> None:
    """Nothing stops the tests."""


class Ends:
    """Ends the process that reads it."""

    def __reduce__(self) -> tuple[object, tuple[int]]:
        return os._exit, (3,)


def test_a_worker_answers_refuses_and_survives_what_ends_its_process(tmp_path: Path) -> None:
    scene = drawn(PLATES, tmp_path)
    with Worker() as worker:
        answer = worker.ask(scene.text, scene.has_readings, QUICK, 60, go_on)
        assert answer.outcome == ANSWERED and answer.values["front: change"].error
        refused = worker.ask(scene.text, scene.has_readings, {"method": "none"}, 60, go_on)
        assert refused.outcome == REFUSED and "none" in refused.reason
        ended = worker.ask(scene.text, scene.has_readings, {"method": Ends()}, 60, go_on)
        assert ended.outcome == ENDED and "status 3" in ended.reason
        assert worker.ask(scene.text, scene.has_readings, QUICK, 60, go_on).outcome == ANSWERED


def test_what_takes_too_long_has_no_answer(tmp_path: Path) -> None:
    scene = drawn(list(KINDS).index("robots"), tmp_path)
    with Worker() as worker:
        assert worker.ask(scene.text, True, METHODS["boundary-elements:1e-2"], 1e-3, go_on).outcome == LATE


def test_two_scenes_are_asked_for_once(tmp_path: Path) -> None:
    asked = run.options("plates,closed-forms", "reduced:1e-2,auto:1e-2", scenes=2, jobs=1)
    league = run.run(tmp_path, asked)
    before = (tmp_path / judging.FILE).read_text()
    assert league.path.read_text() == league.text
    assert set(judging.load(tmp_path)) == {0, list(KINDS).index("closed-forms")}
    assert {row.method for row in league.rows if row.judged} == {"reduced:1e-2", "auto:1e-2"}
    assert {row.method for row in league.rows if row.guesses} == {"auto:1e-2"}
    assert run.run(tmp_path, asked).text == league.text
    assert (tmp_path / judging.FILE).read_text() == before


def test_an_unfinished_line_is_left_out(tmp_path: Path) -> None:
    (tmp_path / judging.FILE).write_text('{"seed": 1, "ki')
    assert judging.load(tmp_path) == {}


def test_every_option_of_the_command_acts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run, "field_answer", lambda *_: Answer(REFUSED, 0.0, "not today"))
    place = ["--results", str(tmp_path), "--methods", "reduced:1e-2", "--no-field-solver", "--seconds", "60"]
    few = ["--scenes", "1", "--first", "1", "--kinds", "plates", "--jobs", "1"]
    done = in_this_process(command_line.main, "honesty", *place, *few)
    told = done.stdout
    assert f"table: {tmp_path / run.TABLE}" in told and "| reduced:1e-2 | plates | 1 |" in told
    assert done.returncode in (0, 1)
    assert set(judging.load(tmp_path)) == {len(KINDS)}
    field = ["--results", str(tmp_path), "--methods", "field-solver", "--field-solver", "1"]
    told = in_this_process(command_line.main, "honesty", *field, *few).stdout
    assert "* field-solver, 1: not today" in told
    told = analysis("honesty", *place, "--only", 0).stdout
    assert "# seed 0: plates" in told and "[[sensor]]" in told and "reduced:1e-2: answered" in told


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["--kinds", "plates,none"], "'none' is none of plates"),
        (["--methods", "exact"], "'exact' is none of formula"),
        (["--field-solver", "2"], "'2' is not a number between 0 and 1"),
        (["--field-solver", "1", "--no-field-solver"], "not allowed with"),
        (["--scenes", "0"], "'0' is not a whole number greater than 0"),
        (["--only", "-1"], "'-1' is not a whole number of at least 0"),
    ],
)
def test_a_wrong_option_is_refused(words: list[str], reason: str, tmp_path: Path) -> None:
    assert reason in analysis("honesty", "--results", tmp_path, *words, status=2).stderr
    assert not list(tmp_path.iterdir())
