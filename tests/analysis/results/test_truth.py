"""The best truth at hand: of two methods the one that states less error, value by value; and what methods refuse."""

import csv
import io
import math
from pathlib import Path
from typing import Any

import pytest

from analysis.results import study_results as results, table
from analysis.results.answers import Estimate
from analysis.results.refusals import refusals, unanswered
from analysis.results.study_results import Failure
from analysis.results.table import Row
from analysis.results.truth import BOUNDARY, ESTIMATED, FIELD, PROVEN, Known
from analysis.study import report, workflow
from geometries.studies import study
from tests.analysis.documents import PICO, boundary_document, model_document, reference_document
from tests.analysis.synthetic import ONE_CASE, PARALLEL, enclosed, make_results, report_text
from tests.programs import analysis


def rows_of(folder: Path, field: float, boundary: float, method: str = study.BOTH) -> list[Row]:
    """The rows of mutual 2 pF and delta_self 1 pF, with these errors (pF)."""
    answers = {0: (reference_document(2, 1, error=field), model_document(1.8))}
    documents = {0: boundary_document(2.001, 1.001, error=boundary)}
    return table.rows(results.load(make_results(folder, ONE_CASE, answers, [], "", method, documents)))


def record_of(rows: list[Row]) -> dict[str, str]:
    return next(iter(csv.DictReader(io.StringIO(table.to_csv(rows, ("exact",))))))


def test_the_method_that_states_less_error_answers(tmp_path: Path) -> None:
    sure, unsure = rows_of(tmp_path / "a", 1.0, 0.004)[0], rows_of(tmp_path / "b", 0.004, 1.0)[0]
    assert (sure.known.answered_by, unsure.known.answered_by) == (BOUNDARY, FIELD)
    assert sure.reference == Estimate(2.001 * PICO, 0.004 * PICO)
    assert unsure.reference == Estimate(2 * PICO, 0.004 * PICO)


def test_each_value_is_answered_by_itself(tmp_path: Path) -> None:
    document = reference_document(2, 1, error=0.01)
    document["delta_self"]["sensor"]["error"] = 1e-5 * PICO
    folder = make_results(
        tmp_path, ONE_CASE, {0: (document, model_document(1.8))}, boundary={0: boundary_document(2, 1)}
    )
    mutual, delta_self = table.rows(results.load(folder))
    assert (mutual.known.answered_by, delta_self.known.answered_by) == (BOUNDARY, FIELD)


@pytest.mark.parametrize("error", [math.nan, math.inf])
def test_an_error_that_is_unknown_never_answers_if_another_is_known(error: float) -> None:
    unknown, known = Estimate(1.0, error), Estimate(2.0, 1.0)
    assert Known(unknown, known).best == known and Known(known, unknown).best == known


def test_a_proven_interval_is_kept_beside_a_smaller_estimate(tmp_path: Path) -> None:
    answers = {0: (enclosed(reference_document(2, 1), 0.2, 0.1), model_document(1.8))}
    folder = make_results(tmp_path, ONE_CASE, answers, boundary={0: boundary_document(2, 1)})
    rows = table.rows(results.load(folder))
    record = record_of(rows)
    assert (rows[0].known.error_kind, record["reference_error_kind"]) == (ESTIMATED, "estimated")
    assert record["field_error_kind"] == PROVEN
    assert float(record["field_error_F"]) == pytest.approx(0.2e-12)
    assert "The field solver proves wider intervals of 1 of them" in report_text(folder)


def test_the_table_has_both_methods_and_names_the_one_that_answers(tmp_path: Path) -> None:
    record = record_of(rows_of(tmp_path, 1.0, 0.004))
    assert record["answered_by"] == "boundary elements" and record["reached"] == "True"
    values = [float(record[name]) for name in ("field_F", "field_error_F", "boundary_F", "boundary_error_F")]
    assert values == pytest.approx([2e-12, 1e-12, 2.001e-12, 0.004e-12])
    assert "--method boundary-elements --rtol 0.0001" in record["command"]


@pytest.mark.parametrize(
    ("boundary", "told"),
    [
        (0.004, ["sure to 0.2 % or better", "by boundary elements with estimated errors"]),
        (4.0, ["no reference knows more than its order of magnitude", "<td>unknown</td>"]),
    ],
)
def test_a_value_is_called_as_sure_as_its_best_method_is(
    tmp_path: Path, boundary: float, told: list[str]
) -> None:
    rows_of(tmp_path, 3.0, boundary)
    text = report_text(tmp_path)
    assert all(words in text for words in told)
    assert "sure to 300" not in text and "sure to 150" not in text


@pytest.mark.parametrize(
    "method, answered_by", [(study.FIELD, FIELD), (study.BOUNDARY_ELEMENTS, BOUNDARY), (study.BOTH, FIELD)]
)
def test_a_method_that_the_study_does_not_ask_answers_nothing(
    tmp_path: Path, method: str, answered_by: str
) -> None:
    mutual, _ = rows_of(tmp_path, 0.001, 0.004, method)
    assert mutual.known.answered_by == answered_by
    assert (mutual.known.field is None) == (method == study.BOUNDARY_ELEMENTS)
    assert (mutual.known.boundary is None) == (method == study.FIELD)


def test_a_study_by_boundary_elements_alone_has_rows_pages_and_no_field_solver(tmp_path: Path) -> None:
    answers = {0: (None, model_document(1.8))}
    documents = {0: boundary_document(2, 1)}
    folder = make_results(tmp_path, ONE_CASE, answers, [], "", study.BOUNDARY_ELEMENTS, documents)
    (found, *_) = results.load(folder).compared()
    text = report_text(folder) + (found.folder / "case.html").read_text()
    assert "by boundary elements" in text and "python3 -m fem_reference" not in text
    assert len(report.make(folder).summaries) == 4
    assert {row.quantity for row in table.rows(results.load(folder))} == {table.MUTUAL, table.DELTA_SELF}


REASON = "links a and b touch"


def refused_by_field(folder: Path, boundary: dict[int, dict[str, Any]] | None = None) -> list[Failure]:
    """Three cases that the field solver refuses, each with its slice."""
    answers: dict[int, Any] = {number: (None, model_document(1.8)) for number in range(3)}
    found = results.load(make_results(folder, PARALLEL, answers)).compared()
    stages = ("reference", "slice of the potential")
    failures = [Failure(case.id, stage, REASON, True) for case in found for stage in stages]
    make_results(folder, PARALLEL, answers, failures, boundary=boundary)
    return failures


def test_equal_reasons_make_one_line_and_rows_of_the_other_method_appear(tmp_path: Path) -> None:
    refused_by_field(tmp_path, {number: boundary_document(2, 1) for number in range(3)})
    (refusal,) = refusals(results.load(tmp_path))
    assert len(refusal.cases) == refusal.answered == 3
    assert refusal.sentence.startswith("the field solver refuses 3 cases (")
    assert refusal.sentence.endswith(f"boundary elements answer: {REASON}")
    text = report_text(tmp_path)
    assert text.count("The field solver refuses 3 cases") == 1 and "The same 6 rows" in text
    assert "answers are missing" not in text


def test_both_methods_have_a_line_of_their_own(tmp_path: Path) -> None:
    refused_by_field(tmp_path, {0: {"refused": "too close"}, 1: boundary_document(2, 1)})
    first, second = (refusal.sentence for refusal in refusals(results.load(tmp_path)))
    assert "boundary elements answer 1 of them: links" in first
    assert second.startswith("boundary elements refuse case") and second.endswith(
        "without another answer: too close"
    )
    assert len(unanswered(results.load(tmp_path))) == 2


def test_reasons_that_differ_in_numbers_make_one_line(tmp_path: Path) -> None:
    documents = {number: {"refused": f"moved by {number}.5e-3 m along (0, 0, 1)"} for number in range(3)}
    make_results(tmp_path, PARALLEL, boundary=documents)
    (refusal,) = refusals(results.load(tmp_path))
    assert len(refusal.cases) == 3 and refusal.sentence.endswith(
        "the field solver answers: moved by 0.5e-3 m along (0, 0, 1) (in the others with other numbers)"
    )


def test_a_method_of_the_model_that_refuses_has_a_line_too(tmp_path: Path) -> None:
    document = model_document(1.8)
    document["methods"]["split:0"] = {"refused": "too far"}
    make_results(tmp_path, PARALLEL, {0: (reference_document(2, 1), document)})
    (refusal,) = refusals(results.load(tmp_path))
    assert refusal.sentence.startswith("the model's split:0 refuses case") and refusal.sentence.endswith(
        ": too far"
    )
    assert "split:0 refuses case" in report_text(tmp_path)


@pytest.mark.parametrize("answered, status", [(True, 0), (False, 1)])
def test_a_refusal_fails_the_run_only_without_another_answer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, answered: bool, status: int
) -> None:
    documents = {number: boundary_document(2, 1) for number in range(3)}
    failures = refused_by_field(tmp_path, documents if answered else None)
    monkeypatch.setattr(workflow, "run", lambda *_: failures)
    told = analysis("run", "smoke", "--results", tmp_path, status=status).stderr.splitlines()
    assert len(told) == 1 and REASON in told[0] and "3 cases" in told[0]
