"""The reference's round, floating and dielectric bodies against known values that do not come from finite elements.

As in test_verification, the known value lies within the stated error, and the stated error is small; `pytest -s` prints both.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.constants import epsilon_0

from analysis.topics.verification.truths import LEKNER
from analysis.topics.verification.truths_of_revolution import (
    body_of_revolution,
    dielectric,
    floating,
    grounded,
    two_balls,
)
from fem_reference.bodies.shapes import Body
from fem_reference.answer.reference import solve_conductors
from fem_reference.bodies.round_bodies import Cone, Cylinder, Sphere
from fem_reference.bodies.conductors import Dielectric, normalised
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


def test_two_balls() -> None:
    found = solve_conductors(normalised(["first", "second"], 1, balls(), [0, 1]), error="estimate").maxwell
    for (i, j), truth in zip(((0, 0), (1, 1), (0, 1)), LEKNER):
        check(f"balls {i}{j}", found.value[i, j], found.error[i, j], truth, 3e-4)


@pytest.mark.parametrize(
    "name, answer, others",
    [
        ("floating", floating, {"floating": ["second"]}),
        ("dielectric", dielectric(5.0), {"dielectrics": [Dielectric("second", 5.0, 5.0)]}),
        ("less than the medium", dielectric(0.2), {"dielectrics": [Dielectric("second", 0.2, 0.2)]}),
    ],
)
def test_a_ball_without_charge_of_its_own(
    name: str, answer: Callable[[int], float], others: dict[str, Any]
) -> None:
    """A floating or dielectric ball has no row, and changes the single entry of the other ball as a multipole expansion predicts."""
    found = solve_conductors(normalised(["first"], 1, balls(), [0, 1], **others), error="estimate")
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
