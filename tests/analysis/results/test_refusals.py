"""What is refused: one line for all cases with the same reason, in the report and on standard error; the exit status."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from analysis import __main__ as command_line
from analysis.pipeline.stage import NoAnswer, Refused, Stage
from analysis.results import study_results as results
from analysis.results.refusals import refusals, unanswered
from analysis.results.study_results import Failure
from analysis.study import workflow
from geometries.studies import study
from tests.analysis.synthetic import (
    PARALLEL,
    boundary_document,
    make_results,
    model_document,
    reference_document,
    report_text,
)

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
    assert "split:4" in report_text(tmp_path)


@pytest.mark.parametrize("answered, status", [(True, 0), (False, 1)])
def test_a_refusal_fails_the_run_only_without_another_answer(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    answered: bool,
    status: int,
) -> None:
    documents = {number: boundary_document(2, 1) for number in range(3)}
    failures = refused_by_field(tmp_path, documents if answered else None)
    monkeypatch.setattr(workflow, "run", lambda *_: failures)
    load = study.load
    monkeypatch.setattr(
        study, "load", lambda name: study.loads(FILE) if Path(name).stem == "smoke" else load(name)
    )
    assert command_line.main(["run", "smoke", "--results", str(tmp_path)]) == status
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 1 and REASON in told[0] and "3 cases" in told[0]


FILE = (
    """
name = "synthetic"
title = "Synthetic answers"
reference = { rtol = 1e-3, max_seconds = 60 }
model = { methods = ["exact"] }
"""
    + PARALLEL
)


@pytest.mark.parametrize("error, refused", [(Refused("no"), True), (NoAnswer("no"), False)])
def test_a_stage_tells_a_refusal_from_a_failure(tmp_path: Path, error: NoAnswer, refused: bool) -> None:
    def answer(_: object) -> dict[str, Any]:
        raise error

    stage = Stage("reference", "case", tmp_path / "fem.json", "key", 1.0, answer)
    assert stage.run(None) == Failure("case", "reference", "no", refused)  # type: ignore[arg-type]
