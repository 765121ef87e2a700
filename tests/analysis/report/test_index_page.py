"""The first screen of a report: a picture and a sentence for each question, in words without symbols."""

from __future__ import annotations

import re
from pathlib import Path

from analysis.report import index_page
from analysis.report.index_page import Answer
from analysis.results import study_results as results, table
from analysis.study import report
from tests.analysis.synthetic import (
    EDGE,
    MACHINE_ANSWERS,
    MACHINES,
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
