"""The reference's round, floating and dielectric bodies against known values that do not come from finite elements.

As in test_verification, the known value lies within the stated error, and the stated error is small; `pytest -s` prints both.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.constants import epsilon_0

from analysis.topics.verification.truths import LEKNER, UNIT_SQUARE_PLATE, UNIT_SQUARE_PLATE_ERROR
from analysis.topics.verification.truths import (
    body_of_revolution,
    dielectric,
    floating,
    grounded,
    two_balls,
)
from scipy.special import elliprf

from fem_reference.bodies.shapes import Body, Cuboid, Disc, PlanePolygon
from fem_reference.answer.reference import solve_conductors
from fem_reference.bodies.round_bodies import Cone, Cylinder, Ellipsoid, Sphere, Swept
from fem_reference.bodies.conductors import Dielectric, normalised
from geometries.scene import polygons
from geometries.scene.poses import AxisRotation

TURNED = AxisRotation((1.0, 2.0, -0.5), 33.0).matrix().T
UNIT = 4 * np.pi * epsilon_0


def check(name: str, value: float, error: float, truth: float, widest: float) -> None:
    off, stated = abs(value / truth - 1), error / abs(truth)
    print(f"\n{name}: off by {off:.1e}, stated {stated:.1e}")
    assert off <= stated <= widest


def balls() -> list[Body]:
    centre = np.array([0.03, 0.0, 0.04])
    return [Sphere("first", np.zeros(3), 0.01), Sphere("second", centre, 0.02)]


def test_the_multipoles_of_two_balls_reproduce_published_values() -> None:
    own, mutual = two_balls(0.01, 0.02, 0.05, grounded)
    other, _ = two_balls(0.02, 0.01, 0.05, grounded)
    np.testing.assert_allclose(UNIT * np.array([own, other, mutual]), LEKNER, rtol=1e-9)


@pytest.mark.night
def test_two_balls() -> None:
    found = solve_conductors(
        normalised(["first", "second"], 1, balls(), [0, 1]), 1.0, 3e-4, error="estimate"
    ).maxwell
    for (i, j), truth in zip(((0, 0), (1, 1), (0, 1)), LEKNER):
        check(f"balls {i}{j}", found.value[i, j], found.error[i, j], truth, 3e-4)


@pytest.mark.parametrize(
    "name, answer, others",
    [
        pytest.param("floating", floating, {"floating": ["second"]}, marks=pytest.mark.night),
        ("dielectric", dielectric(5.0), {"dielectrics": [Dielectric("second", 5.0, 5.0)]}),
        pytest.param(
            "less than the medium",
            dielectric(0.2),
            {"dielectrics": [Dielectric("second", 0.2, 0.2)]},
            marks=pytest.mark.night,
        ),
    ],
)
def test_a_ball_without_charge_of_its_own(
    name: str, answer: Callable[[int], float], others: dict[str, Any]
) -> None:
    """A floating or dielectric ball has no row, and changes the single entry of the other ball as a multipole expansion predicts."""
    found = solve_conductors(normalised(["first"], 1, balls(), [0, 1], **others), 1.0, 3e-4, error="estimate")
    own, _ = two_balls(0.01, 0.02, 0.05, answer)
    assert found.maxwell.value.shape == (1, 1) and found.has_objects
    check(f"{name}, M", found.maxwell.value[0, 0], found.maxwell.error[0, 0], UNIT * own, 3e-4)
    change = found.delta_self
    check(f"{name}, delta_self", change.value[0], change.error[0], UNIT * (own - 0.01), 5e-4)


def test_rings_of_charge_reproduce_known_values() -> None:
    """Check the method on a ball made of 400 flat rings, and against Smythe's formula (1962) for cylinders, accurate to 0.2 %."""
    angles = np.linspace(0, np.pi, 17)
    inscribed = body_of_revolution(list(zip(np.abs(np.sin(angles)), -np.cos(angles))))
    assert 0.99 < inscribed < 1
    cylinder = body_of_revolution([(0, -1), (1, -1), (1, 1), (0, 1)])
    assert cylinder == pytest.approx((8 + 6.95) / (4 * np.pi), rel=2e-3)


@pytest.mark.parametrize(
    "body, outline",
    [
        (Cylinder("cylinder", np.zeros(3), TURNED, 1.0, 2.0), [(0, -1), (1, -1), (1, 1), (0, 1)]),
        (Cone("cone", np.zeros(3), TURNED, 1.0, 1.0), [(0, -0.5), (1, -0.5), (0, 0.5)]),
    ],
    ids=["cylinder", "cone"],
)
def test_bodies_of_revolution(body: Body, outline: list[tuple[float, float]]) -> None:
    found = solve_conductors(normalised([body.name], 1, [body], [0]), error="estimate").maxwell
    truth = UNIT * body_of_revolution(outline)
    check(body.name, found.value[0, 0], found.error[0, 0], truth, 1e-3)


SQUARE = ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))
AT_ORIGIN = np.zeros(3)


@pytest.mark.parametrize(
    "body, truth, exactness, widest",
    [
        # 1/R_F(a², b², c²), which is (1/2)∫ds/√((a² + s)(b² + s)(c² + s)) over 0 … ∞, inverted.
        (
            Ellipsoid("ellipsoid", AT_ORIGIN, TURNED, (1.0, 0.7, 0.5)),
            1 / elliprf(1.0, 0.49, 0.25),
            0,
            1e-3,
        ),
        (Swept("swept point", AT_ORIGIN, TURNED, (0.0, 0.0, 0.0), 1.0), 1.0, 0, 3e-4),
        (Disc("disc", AT_ORIGIN, TURNED, 1.0), 2 / np.pi, 0, 1e-3),
        (
            PlanePolygon("square", AT_ORIGIN, TURNED, np.array(SQUARE), np.array(polygons.ears(SQUARE))),
            UNIT_SQUARE_PLATE,
            UNIT_SQUARE_PLATE_ERROR,
            1e-3,
        ),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_the_capacitance_of_one_body(body: Body, truth: float, exactness: float, widest: float) -> None:
    found = solve_conductors(normalised([body.name], 1, [body], [0]), 1.0, widest, error="estimate").maxwell
    error = found.error[0, 0] + exactness * UNIT * truth
    check(body.name, found.value[0, 0], error, UNIT * truth, widest)


@pytest.mark.night
def test_a_capsule_is_that_of_rings_of_charge() -> None:
    """The outline of the rings is inscribed in the capsule's; two polygons give the limit of infinitely many sides."""

    def inscribed(sides: int) -> float:
        angles = np.linspace(0, np.pi / 2, sides + 1)
        lower = [(float(np.sin(a)), float(-1 - np.cos(a))) for a in angles]
        return body_of_revolution([*lower, *((rho, -z) for rho, z in reversed(lower))])

    coarse, fine = inscribed(4), inscribed(8)
    truth = fine + (fine - coarse) / 3
    capsule = Swept("capsule", AT_ORIGIN, TURNED, (0.0, 0.0, 1.0), 1.0)
    found = solve_conductors(normalised(["capsule"], 1, [capsule], [0]), error="estimate").maxwell
    error = found.error[0, 0] + 0.1 * (fine - coarse) * UNIT
    check("capsule", found.value[0, 0], error, UNIT * truth, 1e-3)


def test_a_cuboid_with_round_edges_lies_between_the_cuboids_around_it_and_within_it() -> None:
    """A conductor that contains another one has the larger capacitance, and a large rounding makes a clear difference."""
    rounded = Swept("rounded", AT_ORIGIN, TURNED, (0.25, 0.25, 0.0), 0.25)
    found = solve_conductors(normalised(["rounded"], 1, [rounded], [0]), error="estimate").maxwell
    value, error = found.value[0, 0], found.error[0, 0]

    def capacitance_of(body: Body) -> float:
        solved = solve_conductors(normalised([body.name], 1, [body], [0]), error="estimate").maxwell
        return float(solved.value[0, 0])

    around = capacitance_of(Cuboid("around", AT_ORIGIN, TURNED, (0.5, 0.5, 0.25)))
    within = capacitance_of(Cuboid("within", AT_ORIGIN, TURNED, (0.25, 0.25, 0.25)))
    assert within < value - error and value + error < around and error < 1e-3 * value
