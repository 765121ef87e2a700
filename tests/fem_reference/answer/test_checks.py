"""Estimates are checked against equal entries and against bounds, and report when they contradict these."""

from __future__ import annotations

import numpy as np
import pytest

from fem_reference.answer.checks import checked
from fem_reference.answer.convergence import Estimate
from fem_reference.solve.enclosure import Enclosure

NOT_EXTRAPOLATED = np.zeros((2, 2), dtype=bool)


def estimate(own: tuple[float, float], error: float) -> Estimate:
    value = np.array([[own[0], -1.0], [-1.0, own[1]]])
    return Estimate(value, np.full((2, 2), error), NOT_EXTRAPOLATED)


def test_entries_that_are_equal_by_symmetry_widen_the_error_to_their_difference() -> None:
    found, contradicted = checked(estimate((4.0, 4.1), 0.06), [(1, 0)], None)
    assert contradicted is None
    np.testing.assert_allclose(found.error, [[0.1, 0.06], [0.06, 0.1]])


def test_entries_that_are_equal_by_symmetry_and_farther_apart_than_their_errors_are_a_contradiction() -> None:
    found, contradicted = checked(estimate((4.0, 4.1), 0.04), [(1, 0)], None)
    assert contradicted is not None and "symmetry" in contradicted
    np.testing.assert_allclose(np.diag(found.error), [0.1, 0.1])


@pytest.mark.parametrize("error, says", [(0.3, None), (0.1, "bounds")])
def test_a_value_outside_of_proven_bounds_is_widened_to_them(error: float, says: str | None) -> None:
    bounds = Enclosure(np.array([[3.0, -1.5], [-1.5, 3.0]]), np.array([[3.8, -0.5], [-0.5, 4.5]]))
    found, contradicted = checked(estimate((4.0, 4.0), error), [], bounds)
    assert (contradicted is None) if says is None else (contradicted is not None and says in contradicted)
    assert found.error[0, 0] == pytest.approx(max(error, 0.2)) and found.error[1, 1] == error


def test_without_anything_to_check_against_the_estimate_stays_what_it_is() -> None:
    before = estimate((4.0, 5.0), 0.1)
    found, contradicted = checked(before, [], None)
    assert contradicted is None and np.array_equal(found.error, before.error)
