"""What every stage has in common: an answer is stored once under its key, and a failure stores nothing."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis.pipeline.processes import Finished, Processes
from analysis.pipeline.stage import NoAnswer, Stage, outdated, parsed, unfinished_file
from analysis.results import store


def stage(folder: Path, key: str = "key", error: Exception | None = None) -> Stage:
    def answer(_: Processes) -> store.Document:
        if error is not None:
            raise error
        return {"value": 1}

    return Stage("speed", "case", folder / "answer.json", key, 1.0, answer)


def test_an_answer_is_stored_under_its_key_and_not_computed_again(tmp_path: Path) -> None:
    assert stage(tmp_path).run(Processes()) is None
    assert store.read_json(tmp_path / "answer.json") == {"key": "key", "value": 1}
    assert outdated([stage(tmp_path)]) == []


def test_an_outdated_answer_is_removed_with_what_killed_writers_left(tmp_path: Path) -> None:
    stage(tmp_path, "old").run(Processes())
    left, of_another = tmp_path / ".answer.host.1.json", tmp_path / ".another.host.1.json"
    left.touch()
    of_another.touch()
    assert len(outdated([stage(tmp_path)])) == 1
    assert list(tmp_path.iterdir()) == [of_another]


@pytest.mark.parametrize("error", [NoAnswer("no memory"), ValueError("no memory"), RuntimeError("no memory")])
def test_a_failure_names_case_and_stage_and_stores_nothing(tmp_path: Path, error: Exception) -> None:
    failure = stage(tmp_path, error=error).run(Processes())
    assert failure is not None
    assert (failure.case, failure.stage, failure.reason) == ("case", "speed", "no memory")
    assert not list(tmp_path.iterdir())


def test_an_error_of_another_kind_is_not_a_failure_of_the_case(tmp_path: Path) -> None:
    with pytest.raises(ModuleNotFoundError):
        stage(tmp_path, error=ModuleNotFoundError("fringe")).run(Processes())


@pytest.mark.parametrize("text", ["", "{", "[1]", "null"])
def test_what_is_no_json_document_is_no_answer(text: str) -> None:
    with pytest.raises(NoAnswer, match="wrote no JSON document"):
        parsed(text)


def test_an_unfinished_file_is_removed_whatever_happens(tmp_path: Path) -> None:
    with pytest.raises(NoAnswer):
        with unfinished_file(tmp_path / "new" / "answer.json") as unfinished:
            unfinished.write_text("half")
            raise NoAnswer
    assert not list((tmp_path / "new").iterdir())


@pytest.mark.parametrize(
    ("errors", "reason"),
    [
        ("first\nno memory\n\n", "no memory"),
        ("", "no message"),
        (" \n", "no message"),
        ("x" * 400, "x" * 300),
    ],
)
def test_the_reason_is_the_last_line_that_a_command_wrote(errors: str, reason: str) -> None:
    assert Finished(2, "", errors).reason == f"exit code 2: {reason}"
