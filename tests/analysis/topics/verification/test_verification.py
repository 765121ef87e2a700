"""The verification: rows kept under their keys, errors against truths, orders, and the chapter told."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis.pipeline import stage
from analysis.pipeline.stage import NoAnswer
from analysis.results import store
from analysis.results.study_results import Failure
from analysis.topics.verification import (
    set_ups as verification_rows,
    topic as verification,
    topic as verification_stage,
    truths,
)
from analysis.topics.verification.set_ups import true_cases
from analysis.topics.verification.topic import VERIFICATION, Row
from tests.analysis.synthetic import make_results, report_text


def quantity(value: float, error: float, **more: Any) -> dict[str, Any]:
    """Of a truth that is 2, known to 1e-6, with levels of order 1 above it."""
    levels = [2.08, 2.04, 2.02]
    return {
        "name": "C11",
        "truth": 2.0,
        "truth_error": 1e-6,
        "value": value,
        "error": error,
        "levels": levels,
    } | more


def truth_row(*quantities: dict[str, Any]) -> dict[str, Any]:
    return {"source": "a book", "seconds": 3.0, "edge_sizes": [0.4, 0.2, 0.1], "quantities": list(quantities)}


INSIDE = quantity(2.002, 0.01, lower=1.99, upper=2.02)
OUTSIDE = quantity(2.02, 0.01, lower=2.01, upper=2.04)


def test_errors_effectivities_and_order_computed_by_hand() -> None:
    (found,) = verification.compared({"a plate": truth_row(INSIDE)})
    assert (found.case, found.quantity, found.source) == ("a plate", "C11", "a book")
    assert (found.off, found.stated) == pytest.approx((0.001, 0.005))
    assert found.effectivity == pytest.approx(5) and found.within
    assert found.half_width == pytest.approx(0.0075) and found.enclosed
    assert found.enclosure_effectivity == pytest.approx(7.5)
    assert found.order == pytest.approx(1)


def test_an_error_below_what_the_truth_is_known_to_counts_as_that() -> None:
    (found,) = verification.compared({"a": truth_row(quantity(2.0, 1e-4))})
    assert found.off == 0 and found.effectivity == pytest.approx(50)
    assert found.half_width is None and found.enclosed is None and found.enclosure_effectivity is None


def test_levels_as_near_as_the_truth_is_known_say_nothing_about_the_order() -> None:
    (found,) = verification.compared({"a": truth_row(quantity(2.0, 1e-4, truth_error=4e-3))})
    assert len(found.clear_levels) == 2 and found.order is None


def test_what_lies_outside_is_named_and_counted() -> None:
    rows = verification.compared({"good": truth_row(INSIDE), "bad": truth_row(OUTSIDE)})
    text = verification.finding(rows)
    assert "1 of 2 known quantities of 2 set-ups are within the stated error" in text
    assert "1 of 2 enclosures hold the truth" in text
    assert text.endswith("Outside: bad, C11.")
    assert "Outside" not in verification.finding(rows[:1])


def test_of_each_case_the_worst_quantity_is_shown() -> None:
    worse = quantity(2.008, 0.01, name="C12")
    rows = verification.compared({"a": truth_row(INSIDE, worse), "b": truth_row(INSIDE)})
    shown = verification.worst_of_each_case(rows)
    assert [(row.case, row.quantity) for row in shown] == [("a", "C12"), ("b", "C11")]


def test_a_carried_error_and_an_interval_are_those_of_the_corners() -> None:
    value, error = np.array([[4.0, -1.0], [-1.0, 3.0]]), np.full((2, 2), 0.01)

    def opposite(m: Any) -> float:
        return float(m[0, 0] - m[0, 1])

    assert verification_rows.carried_error(opposite, value, error) == pytest.approx(0.02)
    low, high = verification_rows.extremes(opposite, value - error, value + error)
    assert (low, high) == pytest.approx((4.98, 5.02))
    low, high = verification_rows.extremes(truths.two_terminal, value - error, value + error)
    assert low < truths.two_terminal(value) < high


def test_the_limit_of_long_bodies_leaves_nothing_of_their_ends() -> None:
    values = [7 * length + 3 + 5 / length for length in (2.0, 4.0, 6.0)]
    limit, change = verification_rows.endless(values, 2.0)
    assert limit == pytest.approx(7) and change == pytest.approx(5 / 24)


def test_every_truth_has_a_set_up_that_can_be_solved_and_a_file_of_its_own(tmp_path: Path) -> None:
    assert all(case.set_up.conductors().names for case in true_cases().values())
    names = [row.id for row in verification_stage.all_rows()]
    assert len({verification_stage.path_of(tmp_path, name) for name in names}) == len(names)


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The rows that are asked to be solved; one called fails does not."""
    names: list[str] = []

    def answer(name: str, _: stage.Processes) -> store.Document:
        names.append(name)
        if name.endswith("fails"):
            raise NoAnswer("no memory")
        return {"row": name, **truth_row(INSIDE)}

    monkeypatch.setattr(verification_stage, "answer", answer)
    return names


ROWS = ["one", "fails", "two"]


def run(folder: Path) -> list[Failure]:
    return VERIFICATION.stages.run(folder, map(Row, ROWS), 1)


def test_finished_rows_are_not_solved_again_and_failures_stop_nothing(
    tmp_path: Path, solved: list[str]
) -> None:
    failures = run(tmp_path)
    assert [(failure.stage, failure.reason) for failure in failures] == [("fails", "no memory")]
    assert solved == ROWS
    run(tmp_path)
    assert solved == [*ROWS, "fails"]
    assert sorted(VERIFICATION.load(tmp_path)) == ["one", "two"]


def test_another_version_makes_all_rows_void(
    tmp_path: Path, solved: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    run(tmp_path)
    monkeypatch.setattr(verification_stage, "code", lambda: "another")
    assert not VERIFICATION.load(tmp_path)
    run(tmp_path)
    assert solved == [*ROWS, *ROWS]


def test_a_report_without_rows_says_how_to_make_them_and_takes_them_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = make_results(tmp_path / "study")
    assert verification.ABSENT in report_text(folder)
    key = verification_stage.key("cube", verification_stage.code())
    target = verification_stage.path_of(VERIFICATION.beside(folder), "cube")
    store.write_json(target, {"key": key, "row": "cube", **truth_row(INSIDE)})
    text = report_text(folder)
    assert verification.TITLE in text and verification.ABSENT not in text
    assert "1 of 1 known quantities of 1 set-ups are within the stated error" in text
    assert "facing strips, width/gap 5" in text, "what is not there yet is named"
