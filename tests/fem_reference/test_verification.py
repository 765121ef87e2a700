"""The reference against known values that do not come from finite elements; `pytest -s` prints both.

Every test asserts two things: the known value lies within the stated error, and the stated error is small. These tests are a sample:
`python3 -m analysis verify` runs every case.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.constants import epsilon_0

from analysis.topics.verification import truths
from analysis.topics.verification.truths import (
    PARALLEL_SQUARES,
    UNIT_CUBE,
    UNIT_SQUARE_PLATE,
    love,
    sphere_and_plane,
    strips,
)
from fem_reference.bodies.shapes import Body, Cuboid, Disc, Rectangle, rectangle
from fem_reference.answer.convergence import SHARED_ERROR, estimate
from fem_reference.answer.reference import Reference, solve_conductors
from fem_reference.bodies.symmetry import mirror_planes
from fem_reference.mesh.size_rules import Sizing
from fem_reference.solve.level import solve_level
from fem_reference.bodies.conductors import normalised


def solve(bodies: list[Body], rtol: float = 1e-3) -> Reference:
    """Solve for bodies that are a conductor each; the first one is the sensor."""
    names = [body.name for body in bodies]
    return solve_conductors(normalised(names, 1, bodies, range(len(bodies))), rtol=rtol, error="estimate")


def two_terminal(reference: Reference) -> tuple[float, float]:
    """The capacitance between two conductors of opposite charge, with the error propagated from those of the entries."""

    value, error = reference.maxwell.value, reference.maxwell.error
    total = 0.0
    for i, j in ((0, 0), (0, 1), (1, 1)):
        step = np.zeros((2, 2))
        step[i, j] = step[j, i] = error[i, j]
        total += abs(truths.two_terminal(value + step) - truths.two_terminal(value - step)) / 2
    return truths.two_terminal(value), total


def check(name: str, value: Any, error: Any, truth: Any, truth_error: float, widest: float) -> None:
    """Assert |value − truth| ≤ error + the truth's own error, and error ≤ widest·|truth|, entry by entry."""
    value, error, truth = np.atleast_1d(value), np.atleast_1d(error), np.atleast_1d(truth)
    off = np.abs(value - truth) / np.abs(truth)
    stated = error / np.abs(truth)
    print(
        f"\n{name}: off by {off.max():.1e}, stated {stated.max():.1e}, off/stated {np.max(off / stated):.2f}"
    )
    assert np.all(off <= stated + truth_error)
    assert stated.max() <= widest


@cache
def square_plate() -> Reference:
    return solve([Rectangle("plate", np.zeros(3), np.eye(3), (0.5, 0.5))], rtol=5e-4)


def test_square_plate() -> None:
    found = square_plate()
    truth = 4 * np.pi * epsilon_0 * UNIT_SQUARE_PLATE
    check("square plate", found.maxwell.value[0, 0], found.maxwell.error[0, 0], truth, 1e-6 / 0.366788, 5e-4)


def test_cube() -> None:
    found = solve([Cuboid("cube", np.zeros(3), np.eye(3), (0.5, 0.5, 0.5))], rtol=7e-4)
    truth = 4 * np.pi * epsilon_0 * UNIT_CUBE
    check("cube", found.maxwell.value[0, 0], found.maxwell.error[0, 0], truth, 1e-12, 7e-4)


def test_loves_equation_reproduces_published_values() -> None:
    assert love(1.0) == pytest.approx(0.579573861, rel=1e-8)
    assert love(0.1) == pytest.approx(2.938980798, rel=1e-8)


def test_elliptic_integrals_reproduce_published_strips() -> None:
    published = {0.5: 1.489949325, 1.0: 2.115778971, 2.0: 3.263468863, 5.0: 6.490675751}
    assert {width: strips(width) for width in published} == pytest.approx(published, rel=1e-9)


def test_the_series_of_sphere_and_plane_reproduces_published_values() -> None:
    published = {1.0: 1.341059813, 0.5: 1.535370509, 0.1: 2.155086117, 0.01: 3.238234662}
    assert {gap: sphere_and_plane(gap) for gap in published} == pytest.approx(published, rel=1e-9)


@pytest.mark.parametrize("separation", [1.0])
def test_coaxial_discs(separation: float) -> None:
    top = np.array([0, 0, separation])
    found = solve([Disc("lower", np.zeros(3), np.eye(3), 1.0), Disc("upper", top, np.eye(3), 1.0)])
    value, error = two_terminal(found)
    check(f"discs {separation}", value, error, 4 * np.pi * epsilon_0 * love(separation), 1e-9, 2e-3)


@pytest.mark.parametrize("gap", [0.2])
def test_parallel_squares(gap: float) -> None:
    top = np.array([0, 0, gap])
    plates: list[Body] = [
        Rectangle(name, np.zeros(3) if name == "lower" else top, np.eye(3), (0.5, 0.5))
        for name in ("lower", "upper")
    ]
    value, error = two_terminal(solve(plates))
    check(f"squares {gap}", value, error, epsilon_0 / gap * PARALLEL_SQUARES[gap], 1e-4, 2e-3)


@pytest.mark.parametrize(
    "name",
    [
        "inclined_hinge1.5_25deg",
        pytest.param("corner_0.8_1.2_height1.5", marks=pytest.mark.night),
        "size_3x3_on_10x10_gap1.5",
        pytest.param("two_sensors_6x10_plate_height2.5", marks=pytest.mark.night),
    ],
)
def test_plates_against_boundary_elements(name: str) -> None:
    case = {case["name"]: case for case in truths.boundary_elements()}[name]
    bodies = [
        rectangle(str(k), *(np.array(plate[key]) for key in ("corner", "edge_u", "edge_v")))
        for k, plate in enumerate(case["rectangles"])
    ]
    owner = [plate["conductor"] for plate in case["rectangles"]]
    sensors = sum(conductor.startswith("sensor") for conductor in case["conductors"])
    found = solve_conductors(normalised(case["conductors"], sensors, bodies, owner), error="estimate")
    assert found.reached
    truth = 1e-12 * np.array(case["maxwell_pF"])
    check(name, found.maxwell.value, found.maxwell.error, truth, case["relative_error"], 1e-3)


@pytest.mark.night
def test_the_error_falls_linearly_with_the_edge_size() -> None:
    """Measures the order of convergence on which extrapolation and adaptation rely, 1, from the true errors of four meshes of halved sizes.

    Values of five are extrapolated.
    """
    problem = normalised(["plate"], 1, [Rectangle("plate", np.zeros(3), np.eye(3), (0.5, 0.5))], [0])
    planes = mirror_planes(problem.bodies, problem.owner)
    levels = [
        solve_level(problem, 1.0, Sizing(growth=0.25, refinement=2.0**k), "none", planes) for k in range(5)
    ]
    truth = 4 * np.pi * epsilon_0 * UNIT_SQUARE_PLATE
    errors = [level.maxwell[0, 0] / truth - 1 for level in levels]
    order = np.polyfit(np.log([level.edge_size for level in levels[:4]]), np.log(errors[:4]), 1)[0]
    print(f"\nobserved order {order:.2f}")
    assert 0.85 <= order <= 1.15
    assert all(error > 0 for error in errors), "a conforming potential has too much energy"
    found = estimate([level.maxwell for level in levels])
    # The error that all levels share was measured at a growth of 0.4; it falls with the sixth power of the growth.
    error = found.error[0, 0] + SHARED_ERROR * (0.25 / 0.4) ** 6 * found.value[0, 0]
    check("five levels", found.value[0, 0], error, truth, 1e-6 / 0.366788, 1e-4)


def test_two_meshes_give_a_small_error() -> None:
    found = solve([Rectangle("plate", np.zeros(3), np.eye(3), (0.5, 0.5))], rtol=1e-4)
    truth = 4 * np.pi * epsilon_0 * UNIT_SQUARE_PLATE
    assert found.reached and len(found.levels) <= 3
    check("adapted", found.maxwell.value[0, 0], found.maxwell.error[0, 0], truth, 1e-6 / 0.366788, 1e-4)
