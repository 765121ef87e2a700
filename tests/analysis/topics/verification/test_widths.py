"""The work for a tenth of an enclosure's width: what is stored, and what the section says of it."""

from __future__ import annotations

import pytest

from analysis import __main__ as command_line
from analysis.topics.verification import widths, widths_section
from analysis.topics.verification.set_ups import true_cases

MESHES = [{"unknowns": 100, "seconds": 1.0, "width": 0.1}, {"unknowns": 400, "seconds": 3.0, "width": 0.01}]
HALVED = [*MESHES, {"unknowns": 700, "seconds": 9.0, "width": 0.001}]


def test_what_is_stored_is_of_set_ups_that_there_are_and_was_reached_by_adapted_meshes() -> None:
    found = widths.stored()
    assert len(found) >= 10 and set(found) <= set(widths.NAMES) <= set(true_cases())
    assert all(widths_section.reached(each, "adapted") for each in found.values())


def test_all_meshes_count() -> None:
    assert widths_section.total(MESHES, "unknowns") == 500 and widths_section.total(MESHES, "seconds") == 3


def test_the_finding_compares_where_both_reach_the_width() -> None:
    answer = {"goal": 0.005, "adapted": HALVED[2:], "halved": HALVED}
    words = widths_section.finding({"one": answer, "other": {**answer, "halved": MESHES}})
    assert "adapted meshes reach a tenth of the width in 2 of 2" in words.lower()
    assert "halved sizes in 1" in words and "1.7 (median" in words and "1 (median" in words


def test_without_measurements_there_is_no_section() -> None:
    assert widths_section.section({}) == ""


def test_a_set_up_that_is_unknown_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert command_line.main(["measure", "widths", "no such set-up"]) == 2
    assert "there are square plate" in capsys.readouterr().err
