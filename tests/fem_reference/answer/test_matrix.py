"""The best value between bounds whose distances from the true value are known, and the checks of estimates.

Estimates are checked against equal entries and against bounds, and report when they contradict these.
"""

from __future__ import annotations

from typing import cast

import numpy as np
import pytest

from fem_reference.answer.convergence import Estimate
from fem_reference.answer.matrix import LEAST_FRACTION_OF_WIDTH, best_value, checked
from fem_reference.mesh.marks import Marks
from fem_reference.solve.enclosure import Enclosure
from fem_reference.solve.level import Level, LevelBounds


NO_MARKS = cast(Marks, None)
"""Those of levels whose errors are not looked at."""
NOT_EXTRAPOLATED = np.zeros((2, 2), dtype=bool)


def level(below: float, above: float, truth: float = 1.0) -> Level:
    """A level with a single entry, whose bounds are `below` and `above` away from the true value."""
    value = np.array([[truth + above]])
    interval = Enclosure(np.array([[truth - below]]), value)
    return Level(1.0, 1, 1, value, value, np.zeros(1), bounds=LevelBounds(interval, None, None, NO_MARKS))


@pytest.mark.parametrize("narrowing", [2.0, 3.6, 1.5])
def test_bounds_that_narrow_in_proportion_meet_in_the_truth(narrowing: float) -> None:
    """The value is found for any ratio of the two widths."""
    found = best_value([level(0.07, 0.1), level(0.07 / narrowing, 0.1 / narrowing)])
    assert found.value[0, 0] == pytest.approx(1, abs=1e-14) and found.extrapolated[0, 0]
    assert found.error[0, 0] == pytest.approx(LEAST_FRACTION_OF_WIDTH * 0.17 / narrowing)


def test_a_mesh_worse_than_a_coarser_one_does_not_matter() -> None:
    found = best_value([level(0.07, 0.1), level(0.2, 0.12), level(0.035, 0.05)])
    assert found.value[0, 0] == pytest.approx(1, abs=1e-14)


def test_bounds_that_hardly_narrow_give_their_middle_and_all_of_it_as_the_error() -> None:
    found = best_value([level(0.07, 0.1), level(0.068, 0.09)])
    assert found.value[0, 0] == pytest.approx(1.011) and found.error[0, 0] == pytest.approx(0.079)
    assert not found.extrapolated[0, 0]


def test_a_single_interval_gives_its_middle_and_half_its_width() -> None:
    found = best_value([level(0.07, 0.1)])
    assert found.value[0, 0] == pytest.approx(1.015) and found.error[0, 0] == pytest.approx(0.085)


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
