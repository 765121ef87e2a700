"""The reference against truths that owe nothing to finite elements; `pytest -s` prints what it found.

Every test asks the same two things: the truth lies within the stated error, and the stated error is small.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.constants import epsilon_0

from fem_reference.bodies import Body, Cuboid, Disc, Rectangle
from fem_reference.reference import Reference, solve_conductors
from fem_reference.scene_bodies import normalised, rectangle

Array = NDArray[np.float64]

UNIT_SQUARE_PLATE = 0.366788
"""C / 4πε0·side; two independent boundary-element computations, 1e-6; HierBEM gives 0.3667874."""
UNIT_CUBE = 0.66067815409957
"""C / 4πε0·side; Helsing & Perfekt 2013."""
PARALLEL_SQUARES = {0.2: 1.5528, 0.5: 2.2364, 1.0: 3.3430}
"""Two-terminal C / (ε0·area/gap) over gap/side; boundary elements, 1e-4."""
BOUNDARY_ELEMENTS = json.loads(Path(__file__).with_name("boundary_elements.json").read_text())["cases"]
"""Maxwell matrices of plates by Galerkin boundary elements on panels graded towards every edge, extrapolated over four
levels. Nothing was fitted to them."""


def solve(bodies: list[Body], rtol: float = 1e-3) -> Reference:
    """Each body a conductor, the first the sensor."""
    names = [body.name for body in bodies]
    return solve_conductors(normalised(names, 1, bodies, range(len(bodies))), rtol=rtol, error="estimate")


def two_terminal(reference: Reference) -> tuple[float, float]:
    """C between two conductors of opposite charge, and its error carried over from the entries' errors."""

    def capacitance(m: Array) -> float:
        return float((m[0, 0] * m[1, 1] - m[0, 1] ** 2) / (m[0, 0] + m[1, 1] + 2 * m[0, 1]))

    value, error = reference.maxwell.value, reference.maxwell.error
    total = 0.0
    for i, j in ((0, 0), (0, 1), (1, 1)):
        step = np.zeros((2, 2))
        step[i, j] = step[j, i] = error[i, j]
        total += abs(capacitance(value + step) - capacitance(value - step)) / 2
    return capacitance(value), total


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
    return solve([Rectangle("plate", np.zeros(3), np.eye(3), (0.5, 0.5))])


def test_square_plate() -> None:
    found = square_plate()
    truth = 4 * np.pi * epsilon_0 * UNIT_SQUARE_PLATE
    check("square plate", found.maxwell.value[0, 0], found.maxwell.error[0, 0], truth, 1e-6 / 0.366788, 5e-4)


def test_cube() -> None:
    found = solve([Cuboid("cube", np.zeros(3), np.eye(3), (0.5, 0.5, 0.5))])
    truth = 4 * np.pi * epsilon_0 * UNIT_CUBE
    check("cube", found.maxwell.value[0, 0], found.maxwell.error[0, 0], truth, 1e-12, 5e-4)


def love(separation: float) -> float:
    """Two-terminal C / 4πε0·radius of coaxial discs `separation` radii apart: Love's equation (Love 1949).

    f(x) + (κ/π) ∫ f(y)/(κ² + (x − y)²) dy = 1 on [−1, 1]; C = (1/2π) ∫ f for discs at opposite potentials. The kernel is
    analytic, so Gauss–Legendre collocation converges geometrically.
    """
    x, weights = np.polynomial.legendre.leggauss(200)
    kernel = separation / np.pi / (separation**2 + (x[:, None] - x) ** 2)
    return float(weights @ np.linalg.solve(np.eye(200) - kernel * weights, np.ones(200)) / (2 * np.pi))


def test_loves_equation_reproduces_published_values() -> None:
    assert love(1.0) == pytest.approx(0.579573861, rel=1e-8)
    assert love(0.1) == pytest.approx(2.938980798, rel=1e-8)


@pytest.mark.parametrize("separation", [0.5, 1.0])
def test_coaxial_discs(separation: float) -> None:
    top = np.array([0, 0, separation])
    found = solve([Disc("lower", np.zeros(3), np.eye(3), 1.0), Disc("upper", top, np.eye(3), 1.0)])
    value, error = two_terminal(found)
    check(f"discs {separation}", value, error, 4 * np.pi * epsilon_0 * love(separation), 1e-9, 2e-3)


@pytest.mark.parametrize("gap", PARALLEL_SQUARES)
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
        "edge_beside0.8_height1.2",
        "straddle_4_height1.5",
        "corner_0.8_1.2_height1.5",
        "size_3x3_on_10x10_gap1.5",
        "two_sensors_6x10_plate_height2.5",
    ],
)
def test_plates_against_boundary_elements(name: str) -> None:
    case = {case["name"]: case for case in BOUNDARY_ELEMENTS}[name]
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


def test_the_error_falls_linearly_with_the_edge_size() -> None:
    """The order of convergence that the extrapolation relies on: 1, from four levels against the truth.

    On the fifth, what all levels share begins to show; the stated error still covers the truth.
    """
    found = solve([Rectangle("plate", np.zeros(3), np.eye(3), (0.5, 0.5))], rtol=1e-4)
    truth = 4 * np.pi * epsilon_0 * UNIT_SQUARE_PLATE
    errors = [level.maxwell[0, 0] / truth - 1 for level in found.levels]
    sizes = [level.edge_size for level in found.levels]
    order = np.polyfit(np.log(sizes[:4]), np.log(errors[:4]), 1)[0]
    print(f"\nobserved order {order:.2f} over the first four of {len(errors)} levels")
    assert len(errors) >= 5 and 0.85 <= order <= 1.15
    assert all(error > 0 for error in errors), "a conforming potential has too much energy"
    check("five levels", found.maxwell.value[0, 0], found.maxwell.error[0, 0], truth, 1e-6 / 0.366788, 1e-4)
