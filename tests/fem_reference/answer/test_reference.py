"""When an answer counts as reached."""

from __future__ import annotations

import numpy as np
import pytest

from fem_reference.answer.convergence import Estimate
from fem_reference.solve.level import Level
from fem_reference.answer.reference import Reference


def answer(levels: int, error: float) -> Reference:
    """The answer for a single sensor, M = 1 F ± `error`, from this number of levels."""
    one = np.ones((1, 1))
    level = Level(1e-3, 1000, 100, 1.0, one, one, np.zeros(1))
    matrix = Estimate(one, error * one, np.zeros((1, 1), dtype=bool))
    change = Estimate(np.zeros(1), np.zeros(1), np.zeros(1, dtype=bool))
    return Reference(("sensor",), 1, matrix, change, (level,) * levels, rtol=1e-3, seconds=1.0)


@pytest.mark.parametrize(
    "levels, error, reached",
    [(3, 9e-4, True), (3, 1.1e-3, False), (2, 9e-4, False), (1, 0.0, False)],
)
def test_reached_takes_a_small_error_and_three_levels(levels: int, error: float, reached: bool) -> None:
    assert answer(levels, error).reached is reached


def test_the_interval_is_the_value_and_its_error() -> None:
    found = answer(3, 0.25)
    assert (found.lower[0, 0], found.upper[0, 0], found.worst) == (0.75, 1.25, 0.25)
