"""The first screen of a report, and the list of everything that was made."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from analysis import commands
from analysis.report import index_page, page, results_page
from analysis.report.index_page import Answer
from analysis.results import study_results as results, table
from analysis.results.store import write_text
from analysis.study import report
from tests.analysis.synthetic import (
    EDGE,
    MACHINES,
    MACHINE_ANSWERS,
    PARALLEL,
    boundary_document,
    make_results,
    model_document,
    reference_document,
)


def answers(folder: Path) -> list[Answer]:
    found = results.load(folder)
    return index_page.how_wrong(found, table.rows(found), "cases")


def test_each_family_is_told_by_where_the_target_is(tmp_path: Path) -> None:
    known = {
        number: (reference_document(2, 1), model_document(value))
        for number, value in enumerate((1.2, 1.4, 0.9, 26.0, 30.0))
    }
    facing, beside = answers(make_results(tmp_path, PARALLEL + EDGE, known))
    assert (facing.question, beside.question) == ("Facing a plate", "Beside an edge")
    assert (
        facing.says
        == "The model's change of the reading is mostly 20 % off, at worst 40 % too high (of 3 values)."
    )
    assert beside.says == (
        "The model's change of the reading is mostly 28 times too high, at worst 30 times too high (of 2 values)."
    )


def test_machines_are_one_question_with_a_picture_of_each(tmp_path: Path) -> None:
    alone, machine = answers(make_results(tmp_path, MACHINES, MACHINE_ANSWERS))
    assert alone.question == "Facing a plate" and len(alone.pictures) == 1
    assert machine.question == "On a machine"
    assert [picture.words for picture in machine.pictures] == [
        "parallel, housing",
        "parallel, housing and guard",
    ]
    assert machine.says == "The model's change of the reading is 125 % too high."


def test_where_the_model_knows_nothing_this_is_said(tmp_path: Path) -> None:
    unknown = {number: (reference, None) for number, (reference, _) in MACHINE_ANSWERS.items()}
    assert {each.says for each in answers(make_results(tmp_path, MACHINES, unknown))} == {
        "The model has no answer here."
    }


def test_the_first_screen_has_no_symbols_and_says_what_speaks_for_the_reference(tmp_path: Path) -> None:
    both = {number: boundary_document(2.002, 1.003) for number in range(5)}
    text = report.make(make_results(tmp_path, boundary=both)).path.read_text()
    (first,) = re.findall(r'<ul class="answers">(.*?)</ul>', text, re.DOTALL)
    words = re.sub(r"<svg.*?</svg>|<[^>]*>", "", first, flags=re.DOTALL)
    assert "agree within the errors that they state in 20 of 20 values" in words
    assert not re.search(r"delta_self|mutual|rms|M\[|ε", words)
    assert 'href="report/cross_check.html"' in first
    assert text.index("What the words mean") > text.index('<ul class="answers">')


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, title in (("default/report", "A < B"), ("default/trends", "Trends"), ("sweep/arm", "Arm")):
        write_text(tmp_path / f"{name}.html", page.document(title, "inputs", [], ""))
    for other in ("default/table.csv", "default/study.json", "default/cases/1/case.html", "coverage/arm.vtu"):
        write_text(tmp_path / other, "")
    write_text(
        tmp_path / "documentation" / "analysis" / "documentation" / "index.html", "<title>Notes</title>"
    )
    return tmp_path


def test_each_page_and_table_is_listed_once(folder: Path) -> None:
    made = results_page.make(folder)
    assert made == folder / "index.html"
    listed = re.findall(r'<a href="(.*?)">(.*?)</a>', made.read_text(encoding="utf-8"))
    assert listed == [
        ("coverage/arm.vtu", "arm.vtu"),
        ("default/report.html", "A &lt; B"),
        ("default/trends.html", "Trends"),
        ("default/table.csv", "table.csv"),
        ("documentation/analysis/documentation/index.html", "Notes"),
        ("sweep/arm.html", "Arm"),
    ]
    assert all((folder / target).is_file() for target, _ in listed)


def test_it_is_written_again_when_something_was_made(folder: Path) -> None:
    made = results_page.make(folder)
    assert made is not None
    before = made.stat().st_mtime_ns
    assert results_page.make(folder) == made and made.stat().st_mtime_ns == before
    write_text(folder / "live" / "head.html", "no title")
    results_page.make(folder)
    assert 'href="live/head.html">head.html' in made.read_text(encoding="utf-8")


def test_there_is_none_where_nothing_was_made(tmp_path: Path) -> None:
    assert results_page.make(tmp_path) is None and results_page.make(tmp_path / "nowhere") is None
    assert not list(tmp_path.iterdir())


def test_a_command_brings_it_up_to_date(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(commands.installation, "results_folder", lambda: folder)
    monkeypatch.setitem(commands._COMMANDS, "show", lambda _: 3)
    assert commands.run_command(type("Options", (), {"command": "show"})()) == 3  # type: ignore[arg-type]
    assert (folder / "index.html").is_file()
