"""The error estimate: exact on sequences that follow the theory, wider whenever a check is skipped or fails. The error of the open
boundary is bounded by that of the multipoles that the charges can have."""

import numpy as np
import pytest

from fem_reference.answer.convergence import (
    LEAST_FRACTION,
    LEAST_FRACTION_CHECKED_TWICE,
    LEAST_OF_TWO_LEVELS,
    UNCHECKED_SAFETY,
    estimate,
)
from fem_reference.answer.shared_errors import open_boundary_error

AGREEING_BY_CHANCE = (2.683719, 2.683916, 2.681565, 2.681252), 2.680950
"""C11 of equal plates, in pF, on four meshes of the case parallel-018 of the corrections; by boundary elements to 1e-5."""

JUMPING = (7.9822, 8.2602, 8.3072, 8.7242, 8.6428, 8.6869)
"""A diagonal entry, in pF, on six meshes of a plate that a grounded plane cuts, for which there is no limit. The last three
differences fall."""


def of(*values: float) -> tuple[float, float, bool]:
    found = estimate([np.array([value]) for value in values])
    return float(found.value[0]), float(found.error[0]), bool(found.extrapolated[0])


@pytest.mark.parametrize(
    "levels, expected",
    [
        pytest.param([3.0], (3.0, 3.0, False), id="one level has an error of its whole value"),
        pytest.param([3.0, 2.5], (2.5, 1.0, False), id="two are not extrapolated"),
        # For 1 + h at h = 4, 2, 1 the limit is 1, and the last difference, 1, is the scale of the error.
        pytest.param([5.0, 3.0, 2.0], (1.0, LEAST_FRACTION, True), id="linear convergence"),
        pytest.param(
            [9.0, 5.0, 3.0, 2.0], (1.0, LEAST_FRACTION_CHECKED_TWICE, True), id="differences fall twice"
        ),
        pytest.param([7.0, 5.0, 3.0, 2.0], (1.0, LEAST_FRACTION, True), id="the first two are equal"),
        pytest.param([2.0, 2.0, 2.0], (2.0, 0.0, True), id="a quantity that does not change has no error"),
    ],
)
def test_sequences_that_follow_the_theory(levels: list[float], expected: tuple[float, float, bool]) -> None:
    assert of(*levels) == expected


def test_two_levels_may_agree_by_chance() -> None:
    """Plates half their size apart: values (pF) on the first three meshes, the third far from the others, and the true value."""
    levels, truth = AGREEING_BY_CHANCE
    value, error, extrapolated = of(*levels[:2])
    assert abs(levels[1] - levels[0]) < abs(value - truth) / 5
    assert not extrapolated and abs(value - truth) <= error == LEAST_OF_TWO_LEVELS * value
    for count in (3, 4):
        value, error, _ = of(*levels[:count])
        assert abs(value - truth) <= error


@pytest.mark.parametrize("edge_sizes", [(4.0, 2.0, 1.0), (8.0, 4.0, 2.0, 1.0)])
@pytest.mark.parametrize("order", [0.8, 1.0, 4 / 3, 1.5, 2.0, 3.0])
def test_the_error_covers_other_orders_of_convergence(order: float, edge_sizes: tuple[float, ...]) -> None:
    """For 1 + h^order the interval contains the limit 1, although the values are extrapolated as if the order were one."""
    value, error, extrapolated = of(*(1 + h**order for h in edge_sizes))
    assert extrapolated and abs(value - 1) <= error


def test_differences_that_fall_fast_are_not_believed_alone() -> None:
    """The finest mesh may be a bad one, so that half of the difference before is a second prediction of the remaining error."""
    value, error, extrapolated = of(5.0, 3.0, 2.9)
    assert extrapolated and value == pytest.approx(2.9 - (0.1 + 1.0) / 2)
    assert error == pytest.approx(1.0 - 0.1)


@pytest.mark.parametrize("values", [(5.0, 4.0, 1.0), (5.0, 3.0, 3.5), (5.0, 4.0, 3.2)])
def test_differences_that_do_not_fall_are_not_extrapolated(values: tuple[float, float, float]) -> None:
    """For growing, alternating or hardly falling differences the value is the finest one, and the error is from the larger difference."""
    value, error, extrapolated = of(*values)
    first, second = abs(values[1] - values[0]), abs(values[2] - values[1])
    assert not extrapolated and value == values[2]
    assert error == pytest.approx(UNCHECKED_SAFETY * max(first / 2, second))


def test_values_that_have_jumped_are_not_extrapolated_and_what_a_jump_leaves_is_in_the_error() -> None:
    value, error, extrapolated = of(*JUMPING)
    jump = JUMPING[3] - JUMPING[2]
    assert not extrapolated and value == JUMPING[-1]
    assert error == pytest.approx(UNCHECKED_SAFETY * jump / 4)
    assert error > 1e-2 * value


def test_every_quantity_is_judged_by_itself() -> None:
    found = estimate([np.array([5.0, 5.0]), np.array([3.0, 4.0]), np.array([2.0, 1.0])])
    assert found.extrapolated.tolist() == [True, False]


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
