"""rms, median and worst of the model errors for each family and quantity, on numbers computed by hand."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from analysis.results import statistics, study_results as results, table
from tests.analysis.synthetic import make_results, model_document, reference_document


@pytest.fixture
def summaries(tmp_path: Path) -> dict[tuple[str, str], statistics.Summary]:
    """Three parallel cases off by −10 %, +20 %, −40 %, two edge cases off by 0 and +50 %."""
    models = [1.8, 2.4, 1.2, 2.0, 3.0]
    errors = [0.01, 0.02, 0.01, 0.01, 0.05]
    answers = {
        number: (reference_document(2, 1, error=error), model_document(model))
        for number, (model, error) in enumerate(zip(models, errors))
    }
    found = statistics.summaries(table.rows(results.load(make_results(tmp_path, answers=answers))))
    return {(summary.family, summary.quantity): summary for summary in found}


def test_every_family_and_all_together_are_summed_up_in_both_quantities(
    summaries: dict[tuple[str, str], statistics.Summary]
) -> None:
    assert set(summaries) == {(f, q) for f in ("all", "parallel", "edge") for q in ("mutual", "delta_self")}


def test_the_numbers_of_one_family(summaries: dict[tuple[str, str], statistics.Summary]) -> None:
    parallel = summaries["parallel", "mutual"]
    assert parallel.count == 3
    assert parallel.rms == pytest.approx(math.sqrt((0.01 + 0.04 + 0.16) / 3))
    assert parallel.median == pytest.approx(0.2)
    assert parallel.worst == pytest.approx(-0.4)
    assert parallel.sure_to == pytest.approx(0.01)


def test_the_numbers_over_all_families(summaries: dict[tuple[str, str], statistics.Summary]) -> None:
    whole = summaries["all", "mutual"]
    assert whole.count == 5
    assert whole.rms == pytest.approx(math.sqrt((0.01 + 0.04 + 0.16 + 0 + 0.25) / 5))
    assert whole.worst == pytest.approx(0.5)
    assert whole.sure_to == pytest.approx(0.025)


def test_the_headline_tells_both_quantities_apart(
    summaries: dict[tuple[str, str], statistics.Summary]
) -> None:
    mutual, delta_self = statistics.headline(list(summaries.values())).splitlines()
    assert mutual.startswith("mutual") and "worst +50.0%" in mutual and "2.5 %" in mutual
    assert delta_self.startswith("delta_self")
