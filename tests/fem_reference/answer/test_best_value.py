"""The best value between bounds whose distances from the true value are known."""

from __future__ import annotations

import numpy as np
import pytest

from fem_reference.answer.best_value import LEAST_FRACTION_OF_WIDTH, best_value
from fem_reference.solve.enclosure import Enclosure
from fem_reference.solve.level import Level


def level(below: float | None, above: float, truth: float = 1.0) -> Level:
    """A level with a single entry, whose bounds are `below` and `above` away from the true value."""
    value = np.array([[truth + above]])
    interval = None if below is None else Enclosure(np.array([[truth - below]]), value)
    return Level(1.0, 1, 1, 0.0, value, value, np.zeros(1), enclosure=interval)


@pytest.mark.parametrize("narrowing", [2.0, 3.6, 1.5])
def test_bounds_that_narrow_in_proportion_meet_in_the_truth(narrowing: float) -> None:
    """The value is found for any ratio of the two widths."""
    found = best_value([level(0.07, 0.1), level(0.07 / narrowing, 0.1 / narrowing)])
    assert found.value[0, 0] == pytest.approx(1, abs=1e-14) and found.extrapolated[0, 0]
    assert found.error[0, 0] == pytest.approx(LEAST_FRACTION_OF_WIDTH * 0.17 / narrowing)


def test_levels_without_bounds_between_do_not_matter() -> None:
    found = best_value([level(0.07, 0.1), level(None, 0.03), level(0.035, 0.05)])
    assert found.value[0, 0] == pytest.approx(1, abs=1e-14)


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
