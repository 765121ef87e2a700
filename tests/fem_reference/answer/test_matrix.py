"""The best value between bounds whose distances from the true value are known, and the checks of estimates.

Estimates are checked against equal entries and against bounds, and report when they contradict these.
"""

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


WIDTH = LEAST_FRACTION_OF_WIDTH * 0.17


@pytest.mark.parametrize(
    "bounds, value, error, extrapolated",
    [
        pytest.param([(0.07, 0.1), (0.035, 0.05)], 1, WIDTH / 2, True, id="narrow by 2"),
        pytest.param([(0.07, 0.1), (0.07 / 3.6, 0.1 / 3.6)], 1, WIDTH / 3.6, True, id="narrow by 3.6"),
        pytest.param([(0.07, 0.1), (0.07 / 1.5, 0.1 / 1.5)], 1, WIDTH / 1.5, True, id="narrow by 1.5"),
        pytest.param(
            [(0.07, 0.1), (0.2, 0.12), (0.035, 0.05)],
            1,
            WIDTH / 2,
            True,
            id="a mesh worse than a coarser one",
        ),
        pytest.param(
            [(0.07, 0.1), (0.068, 0.09)], 1.011, 0.079, False, id="hardly narrow: the middle, and all of it"
        ),
        pytest.param(
            [(0.07, 0.1)], 1.015, 0.085, False, id="a single interval: its middle, and half its width"
        ),
    ],
)
def test_bounds_that_narrow_in_proportion_meet_in_the_truth_and_others_give_their_middle(
    bounds: list[tuple[float, float]], value: float, error: float, extrapolated: bool
) -> None:
    """The truth is 1; each level has bounds that are this far below and above it."""
    found = best_value([level(*each) for each in bounds])
    assert found.value[0, 0] == pytest.approx(value, abs=1e-14) and found.error[0, 0] == pytest.approx(error)
    assert bool(found.extrapolated[0, 0]) is extrapolated


def estimate(own: tuple[float, float], error: float) -> Estimate:
    value = np.array([[own[0], -1.0], [-1.0, own[1]]])
    return Estimate(value, np.full((2, 2), error), NOT_EXTRAPOLATED)


@pytest.mark.parametrize("error, contradicts", [(0.06, False), (0.04, True)])
def test_entries_that_are_equal_by_symmetry_widen_the_error_to_their_difference(
    error: float, contradicts: bool
) -> None:
    """It is a contradiction if they are farther apart than their errors allow."""
    found, contradicted = checked(estimate((4.0, 4.1), error), [(1, 0)], None)
    words = "entries that are equal by symmetry differ by more than their errors"
    assert contradicted == (words if contradicts else None)
    np.testing.assert_allclose(found.error, [[0.1, error], [error, 0.1]])


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
