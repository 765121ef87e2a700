"""`diff`: what moved, what got slower, what is new or gone, and the exit code that says so."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from analysis import __main__ as command_line
from analysis.study import report
from analysis.topics.history import difference
from tests.analysis.synthetic import make_results, model_document, reference_document

NAME = ("case", "sensor", "target", "mutual")


def line(
    value: float = 2.0, error: float = 0.1, seconds: float = 10.0, model: float = 1.8
) -> difference.Line:
    estimate = difference.Estimate(value, error)
    return difference.Line("parallel", estimate, seconds, {"exact": model}, {"exact": 1e-6})


def between(old: difference.Line, new: difference.Line) -> difference.Difference:
    return difference.between({NAME: old}, {NAME: new})


@pytest.mark.parametrize(
    ("new", "who"),
    [
        (line(2.19), []),
        (line(2.21), ["reference"]),
        (line(2.31, error=0.3), []),
        (line(math.nan), ["reference"]),
        (line(model=1.8 * (1 + 1e-12)), []),
        (line(model=1.8 * (1 + 1e-8)), ["model exact"]),
        (line(model=math.inf), ["model exact"]),
    ],
)
def test_a_value_has_moved_when_it_changed_by_more_than_its_errors(
    new: difference.Line, who: list[str]
) -> None:
    found = between(line(), new)
    assert [change.who for change in found.moved] == who and found.drifted == bool(who)


def test_values_that_are_infinite_in_both_have_not_moved() -> None:
    assert not between(line(model=math.inf), line(model=math.inf)).drifted


def test_longer_times_are_told_and_are_no_drift() -> None:
    found = between(line(seconds=10), line(seconds=16))
    assert [slower.who for slower in found.slower] == ["reference"] and not found.drifted
    assert not between(line(seconds=1), line(seconds=3)).slower


def test_rows_that_are_new_or_gone_are_told_and_are_no_drift() -> None:
    other = ("other", *NAME[1:])
    found = difference.between({NAME: line()}, {other: line()})
    assert (found.new, found.gone, found.drifted) == ([other], [NAME], False)


@pytest.fixture
def folders(tmp_path: Path) -> tuple[Path, Path]:
    """Results in which one case's mutual is 2.0 ± 0.01 pF, then 2.1 ± 0.01 pF."""
    answers = {0: (reference_document(2.1, 1), model_document(1.8))}
    old, new = make_results(tmp_path / "old"), make_results(tmp_path / "new", answers=answers)
    for folder in (old, new):
        report.make(folder)
    return old, new


def test_drift_ends_with_code_1_a_table_and_a_document(
    folders: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    document = tmp_path / "difference.json"
    assert command_line.main(["diff", *map(str, folders), "--output", str(document)]) == 1
    printed = capsys.readouterr().out
    assert "1 values moved by more than their errors" in printed and "+5.00e-02" in printed
    told = json.loads(document.read_text())
    assert told["drifted"] and told["moved"][0]["who"] == "field solver"
    assert told["moved"][0]["over_errors"] == pytest.approx(5)


def test_no_drift_ends_with_code_0_for_folders_and_tables(folders: tuple[Path, Path]) -> None:
    old, _ = folders
    assert command_line.main(["diff", str(old), str(old / "table.csv")]) == 0


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (None, "cannot be read"),
        ("a,b\n1,2\n", "is missing from the columns of this table"),
        (
            "case,sensor,object,quantity,family,reference_F,reference_error_F,reference_seconds\na,b,c,d,e,x,1,1\n",
            "line 2: is not a row of a table",
        ),
    ],
)
def test_wrong_tables_end_with_code_2_and_a_reason(
    text: str | None,
    told: str,
    folders: tuple[Path, Path],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    wrong = tmp_path / "wrong.csv"
    if text is not None:
        wrong.write_text(text)
    assert command_line.main(["diff", str(folders[0]), str(wrong)]) == 2
    printed = capsys.readouterr()
    assert told in printed.err and not printed.out
