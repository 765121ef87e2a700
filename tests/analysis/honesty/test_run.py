"""Two small scenes asked in earnest, what is kept of them, and what the command makes of its options."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from analysis import __main__ as command_line
from analysis.honesty import judging, run
from analysis.honesty.asking import Worker
from analysis.honesty.kinds import KINDS, drawn
from analysis.honesty.methods import ANSWERED, ENDED, LATE, METHODS, REFUSED, Answer
from analysis.pipeline import model_stage

needs_model = pytest.mark.skipif(
    not model_stage.model_is_built(), reason="the model's Python module is not built"
)
QUICK = {"method": "reduced"}
PLATES = 0


def go_on() -> None:
    """Nothing stops the tests."""


class Ends:
    """Ends the process that reads it."""

    def __reduce__(self) -> tuple[object, tuple[int]]:
        return os._exit, (3,)


@needs_model
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


@needs_model
def test_what_takes_too_long_has_no_answer(tmp_path: Path) -> None:
    scene = drawn(list(KINDS).index("robots"), tmp_path)
    with Worker() as worker:
        assert worker.ask(scene.text, True, METHODS["boundary-elements:1e-2"], 1e-3, go_on).outcome == LATE


@needs_model
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


@needs_model
def test_an_unfinished_line_is_left_out(tmp_path: Path) -> None:
    (tmp_path / judging.FILE).write_text('{"seed": 1, "ki')
    assert judging.load(tmp_path) == {}


@needs_model
def test_every_option_of_the_command_acts(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run, "field_answer", lambda *_: Answer(REFUSED, 0.0, "not today"))
    place = ["--results", str(tmp_path), "--methods", "reduced:1e-2", "--no-field-solver", "--seconds", "60"]
    few = ["--scenes", "1", "--first", "1", "--kinds", "plates", "--jobs", "1"]
    status = command_line.main(["honesty", *place, *few])
    told = capsys.readouterr().out
    assert f"table: {tmp_path / run.TABLE}" in told and "| reduced:1e-2 | plates | 1 |" in told
    assert status in (0, 1)
    assert set(judging.load(tmp_path)) == {len(KINDS)}
    field = ["--results", str(tmp_path), "--methods", "field-solver", "--field-solver", "1"]
    command_line.main(["honesty", *field, *few])
    assert "* field-solver, 1: not today" in capsys.readouterr().out
    assert command_line.main(["honesty", *place, "--only", "0"]) == 0
    told = capsys.readouterr().out
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
def test_a_wrong_option_is_refused(
    words: list[str], reason: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    try:
        status = command_line.main(["honesty", "--results", str(tmp_path), *words])
    except SystemExit as end:
        status = end.code  # type: ignore[assignment]
    assert status == 2 and reason in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
