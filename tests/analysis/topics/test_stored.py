"""Records kept beside a topic's code: what has none is solved, and what a page says of readings by two methods."""

import json
import math
from dataclasses import replace
from pathlib import Path

import pytest

from analysis import commands
from analysis.__main__ import _MEASURES
from analysis.pipeline.stage import NoAnswer
from analysis.results.answers import Estimate
from analysis.results.store import Document
from analysis.topics import stored
from analysis.topics.company.set_ups import CHECK, SetUp, all_set_ups, chosen
from analysis.topics.stored import Comparison, Completed, FieldCheck, Stored, quantities_of, rounded
from tests.programs import analysis

FIRST, SECOND = all_set_ups()[:2]
RECORD = {"value": 2.0}


def kept_in(folder: Path, solved: list[SetUp]) -> Stored[SetUp]:
    def solve(set_up: SetUp) -> Document:
        solved.append(set_up)
        if set_up.id == all_set_ups()[2].id:
            raise NoAnswer("too large")
        return dict(RECORD)

    return Stored(folder / "field_checks.json", "What it is.", lambda: (FIRST, SECOND), solve)


def test_what_has_no_record_is_solved_and_what_is_no_set_up_is_dropped(tmp_path: Path) -> None:
    solved: list[SetUp] = []
    kept = kept_in(tmp_path, solved)
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
    kept = kept_in(tmp_path, solved)
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
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    solved: list[SetUp] = []
    kept = kept_in(tmp_path, solved)
    monkeypatch.setitem(commands._CHECKS, "company", kept)
    asked = ("measure", "field-check", "company")
    analysis(*asked, "--seconds", "1e-9", status=1)
    assert "company: 2 set-ups solved, 0 remain without a record" in analysis(*asked).stdout
    assert len(solved) == 2
    assert "--boundary is an option of insulators" in analysis(*asked, "--boundary", status=2).stderr
    monkeypatch.setitem(commands._TRUTHS, "machines", kept_in(tmp_path / "machines", solved))
    assert analysis("measure", "truths", "machines").stdout == "machines: 2 set-ups solved\n"
    assert set(commands.MEASURES) == set(_MEASURES)
    for what, topics in {"truths": commands._TRUTHS, "field-check": commands._CHECKS}.items():
        ((_, more), *_) = _MEASURES[what][1]
        assert set(more["choices"]) == set(topics)


def test_a_record_may_hold_both_methods(tmp_path: Path) -> None:
    kept = kept_in(tmp_path, [])
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


PICO = 1e-12
PROVEN = (1.99 * PICO, 2.03 * PICO)


def made_up(
    over_errors: float, proven: tuple[float, float] = (-math.inf, math.inf)
) -> list[Comparison[SetUp]]:
    """Two values that agree, and one whose methods differ by so many times their errors."""
    field, background = Estimate(2 * PICO, 0.01 * PICO), Estimate(PICO, 0.01 * PICO)
    apart = Estimate(2 * PICO + over_errors * 0.015 * PICO, 0.005 * PICO)
    return [
        Comparison(chosen()[0], "value", field, field),
        Comparison(chosen()[0], "background", background, background),
        Comparison(chosen()[0], "change", field, apart, proven),
    ]


def test_a_difference_beyond_the_errors_is_told_with_its_set_up() -> None:
    agreeing, apart = made_up(0.5), made_up(2.0)
    assert [each.over_errors for each in agreeing] == pytest.approx([0, 0, 0.5])
    assert agreeing[2].difference == pytest.approx(0.00375) and agreeing[2].allowed == pytest.approx(0.0075)
    told = stored.finding(CHECK, agreeing)
    assert "In 1 set-ups" in told and "3 of 3 values agree" in told and "proves" not in told
    assert (
        "change 1 of 1 within the errors and 1 within 0.5 %, at most 0.50 of the errors and +0.38 %" in told
    )
    told = stored.finding(CHECK, apart)
    assert "2 of 3 values agree" in told
    assert told.endswith(f"Beyond their errors: change of set-up {chosen()[0].id} (2.00).")


def test_proven_intervals_are_counted_and_what_lies_outside_is_told() -> None:
    check = replace(CHECK, quantities=("change",))
    whole, outside = ([made_up(over, PROVEN)[2]] for over in (0.5, 3.0))
    assert "1 of 1 values by boundary elements lie in the interval" in stored.finding(check, whole)
    assert "half-width is 1 % of the value" in stored.finding(check, whole)
    told = stored.finding(check, outside)
    assert "0 of 1 values by" in told and told.endswith(f"change of set-up {chosen()[0].id} (3.00).")
    text = "".join(stored.parts(check, whole))
    assert "1.99 and 2.03" in text and "<td>yes</td>" in text


def test_the_section_shows_the_comparison_or_says_that_there_is_none() -> None:
    text = "".join(stored.parts(CHECK, made_up(0.5)))
    assert text.count("plotly-graph-div") == 1 and "2.000 ± 0.010" in text and "<td>0.50</td>" in text
    assert chosen()[0].machine in text and "forty minutes" in text and "within</th>" not in text
    assert stored.ABSENT in "".join(stored.parts(CHECK, []))
