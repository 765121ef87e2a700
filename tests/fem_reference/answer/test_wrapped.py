"""What wraps cost on any mesh: no finer one is solved if that is more than was asked for."""

from __future__ import annotations

import numpy as np
import pytest

from fem_reference.answer.wrapped import GeometryError
from fem_reference.bodies.conductors import Measured

GROWTH = np.array([[0.02, -0.01], [-0.01, 0.04]])
MAXWELL = np.array([[2.0, -0.1], [-0.1, 8.0]])
COST = GeometryError(
    GROWTH, np.array([0.01]), np.ones((2, 2), bool), np.ones((2, 2), bool), np.array([0.003])
)


@pytest.mark.parametrize(
    "only_readings, delta_self, change, least",
    [(False, 1.0, 1.0, 0.1), (False, 0.05, 1.0, 0.2), (True, 0.05, 1.0, 0.01), (True, 0.05, 0.1, 0.03)],
)
def test_the_least_error_is_that_of_what_was_asked_for(
    only_readings: bool, delta_self: float, change: float, least: float
) -> None:
    reading = Measured("front", 0, (0,))
    found = COST.least_error(MAXWELL, np.array([delta_self]), [reading], np.array([change]), only_readings)
    assert found == pytest.approx(least)
