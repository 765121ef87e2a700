"""Records kept beside a topic's code: what has none is solved, what is no set-up is dropped, and numbers are rounded."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import pytest

from analysis.pipeline.stage import NoAnswer
from analysis.results.store import Document
from analysis.topics import field_check, truths
from analysis.topics.company.set_ups import SetUp, all_set_ups
from analysis.topics.field_solver import FieldCheck, quantities_of
from analysis.topics.stored import Completed, Stored, rounded
from geometries.common.errors import InputError

FIRST, SECOND = all_set_ups()[:2]
RECORD = {"value": 2.0}


def stored(folder: Path, solved: list[SetUp]) -> Stored[SetUp]:
    def solve(set_up: SetUp) -> Document:
        solved.append(set_up)
        if set_up.id == all_set_ups()[2].id:
            raise NoAnswer("too large")
        return dict(RECORD)

    return Stored(folder / "field_checks.json", "What it is.", lambda: (FIRST, SECOND), solve)


def test_what_has_no_record_is_solved_and_what_is_no_set_up_is_dropped(tmp_path: Path) -> None:
    solved: list[SetUp] = []
    kept = stored(tmp_path, solved)
    assert kept.records() == {}
    assert kept.complete() == Completed(2, 0) and solved == [FIRST, SECOND]
    assert kept.records() == {FIRST.identity: RECORD, SECOND.identity: RECORD}
    assert kept.complete() == (0, 0) and len(solved) == 2
    document = json.loads(kept.file.read_text())
    assert document["description"] == "What it is."
    document["checks"]["another"] = document["checks"].pop(FIRST.identity)
    kept.file.write_text(json.dumps(document))
    assert kept.complete() == (1, 0) and solved == [FIRST, SECOND, FIRST]
    assert set(kept.records()) == {FIRST.identity, SECOND.identity}
    assert kept.complete([SECOND]) == (0, 0) and set(kept.records()) == {SECOND.identity}


def test_none_is_begun_after_the_time_and_one_without_an_answer_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    solved: list[SetUp] = []
    kept = stored(tmp_path, solved)
    assert kept.complete(seconds=0) == (0, 2) and not solved and not kept.file.exists()
    third = all_set_ups()[2]
    assert kept.complete([third]) == (0, 1) and not kept.file.exists()
    assert f"{third.id}: too large" in capsys.readouterr().err


def test_numbers_are_rounded_wherever_they_stand() -> None:
    assert rounded({"a": 1.23456789, "b": [{"c": 2.00000009}, "d", 3]}) == {
        "a": 1.234568,
        "b": [{"c": 2.0}, "d", 3],
    }


def test_the_commands_solve_by_topic_and_tell_what_is_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    solved: list[SetUp] = []
    kept = stored(tmp_path, solved)
    monkeypatch.setitem(field_check._STORED, "company", kept)
    parser = argparse.ArgumentParser()
    field_check.arguments(parser)
    assert field_check.measure(parser.parse_args(["company", "--seconds", "1e-9"])) == 1
    assert field_check.measure(parser.parse_args(["company"])) == 0 and len(solved) == 2
    assert "company: 2 set-ups solved, 0 remain without a record" in capsys.readouterr().out
    with pytest.raises(InputError, match="--boundary is an option of insulators"):
        field_check.measure(parser.parse_args(["company", "--boundary"]))
    monkeypatch.setitem(truths._MAKE, "machines", lambda: 3)
    parser = argparse.ArgumentParser()
    truths.arguments(parser)
    assert truths.measure(parser.parse_args(["machines"])) == 0
    assert capsys.readouterr().out == "machines: 3 set-ups solved\n"
    assert set(field_check._STORED) == {"company", "insulators", "machines"}
    assert set(truths._MAKE) == {"corrections", "insulators", "machines"}


def test_a_record_may_hold_both_methods(tmp_path: Path) -> None:
    kept = stored(tmp_path, [])
    reading = {"change": 2.0, "value": 4.0, "error": {"change": 0.01, "value": 0.03}}
    record = {"field": quantities_of(reading, ("change", "value")), "boundary": {}}
    record["boundary"] = quantities_of({**reading, "change": 2.1}, ("change", "value"))
    kept.write({SECOND.identity: record})
    change, value = FieldCheck(
        file=kept.file,
        description="",
        chosen=kept.chosen,
        solve=kept.solve,
        kind=lambda each: each.machine,
        described=(),
        quantities=("change", "value"),
        both=True,
    ).comparisons()
    assert (change.set_up, change.quantity) == (SECOND, "change") and value.over_errors == 0
    assert change.difference == pytest.approx(0.05) and change.over_errors == pytest.approx(5)
    assert change.is_enclosed, "nothing is proven"
