"""Readings in matrices that are known: their bounds, and conductors that are connected to ground through a capacitance."""

from __future__ import annotations

import numpy as np
import pytest

from fem_reference.bodies.conductors import Measured
from fem_reference.solve.field_problem import without_floating
from fem_reference.solve.readings import reading_bounds

READINGS = (Measured("self", 0, (0,)), Measured("guarded", 0, (0, 2)), Measured("transmitted", 1, (0, 2)))


def positive(random: np.random.Generator, size: float) -> np.ndarray:
    """A positive semidefinite matrix."""
    root = random.normal(size=(3, 3))
    return np.asarray(size * root @ root.T)


def test_a_reading_lies_between_the_bounds_of_two_quadratic_forms() -> None:
    random = np.random.default_rng(1)
    for _ in range(50):
        matrix = positive(random, 1.0)
        found = reading_bounds(READINGS, matrix - positive(random, 0.1), matrix + positive(random, 0.1), 0.0)
        values = [matrix[0, 0], matrix[0, 0] + matrix[0, 2], -matrix[1, 0] - matrix[1, 2]]
        assert np.all(found[:, 0] <= values) and np.all(values <= found[:, 1])


def test_equal_forms_leave_no_doubt() -> None:
    matrix = positive(np.random.default_rng(2), 1.0)
    np.testing.assert_allclose(*reading_bounds(READINGS, matrix, matrix, 0.0).T, atol=1e-12)


def test_curved_surfaces_widen_the_bounds_by_their_share_of_both_energies() -> None:
    matrix = positive(np.random.default_rng(3), 1.0)
    width = np.ptp(reading_bounds(READINGS[:1], matrix, matrix, 1e-3), axis=1)
    assert width == pytest.approx(2e-3 * matrix[0, 0])


def test_a_capacitance_to_ground_is_between_floating_and_grounded() -> None:
    """The energy for any voltages grows with the capacitance: the conductor's potential is less free to follow."""
    matrix = positive(np.random.default_rng(4), 1.0)
    own = [without_floating(matrix, 1, [capacitance]) for capacitance in (0.0, 0.1, 1.0, 1e9)]
    for less, more in zip(own, own[1:]):
        assert np.all(np.linalg.eigvalsh(more - less) > -1e-12)
    np.testing.assert_allclose(own[0], without_floating(matrix, 1))
    np.testing.assert_allclose(own[-1], matrix[:2, :2], atol=1e-8)
