"""The error of the open boundary is bounded by that of the multipoles that the charges can have."""

import numpy as np

from fem_reference.answer.shared_errors import open_boundary_error


def test_open_boundary_error_falls_with_the_third_power_of_the_radius() -> None:
    maxwell = np.array([[6.0, -3.0], [-3.0, 7.0]])
    near, far = open_boundary_error(maxwell, 1.0, 50.0), open_boundary_error(maxwell, 1.0, 100.0)
    np.testing.assert_allclose(near / far, 8.0, rtol=1e-3)


def test_open_boundary_error_bounds_a_dipole() -> None:
    """For two charges ±q at ±a on the axis of a sphere of radius R the dipole's part of ∫(1/R)u² is 16πq²a²/3R³ over (4π)²."""
    q, a, radius = 1.0, 1.0, 100.0
    dipole_energy = (2 * q * a) ** 2 / (4 * np.pi) ** 2 * 4 * np.pi / 3 / radius**3
    maxwell = np.array([[q]])
    assert open_boundary_error(maxwell, a, radius)[0, 0] >= dipole_energy
