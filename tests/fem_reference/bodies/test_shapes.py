"""The closed forms of the bodies' distances, compared with the smallest distance to sampled points."""

import numpy as np
import pytest

from fem_reference.bodies.shapes import Cuboid, Disc, Rectangle, separation
from fem_reference.mesh.body_distances import edge_distance
from geometries.scene.poses import AxisRotation

TURNED = AxisRotation((1.0, 2.0, -0.5), 33.0).matrix().T


def test_edge_distance_of_a_rectangle_is_the_distance_to_its_outline() -> None:
    plate = Rectangle("plate", np.array([0.3, -0.2, 0.1]), TURNED, (0.5, 0.2))
    corners = plate.corners
    s = np.linspace(0, 1, 2001)[:, None]
    outline = np.concatenate([(1 - s) * corners[k] + s * corners[(k + 1) % 4] for k in range(4)])
    points = np.random.default_rng(1).uniform(-1, 1, (50, 3))
    nearest = np.linalg.norm(points[:, None] - outline, axis=2).min(axis=1)
    np.testing.assert_allclose(edge_distance(plate, points.T), nearest, atol=1e-4)


def test_edge_distance_of_a_disc_is_the_distance_to_its_circle() -> None:
    disc = Disc("disc", np.array([0.3, -0.2, 0.1]), TURNED, 0.4)
    angle = np.linspace(0, 2 * np.pi, 4001)[:, None]
    circle = disc.centre + 0.4 * (np.cos(angle) * TURNED[0] + np.sin(angle) * TURNED[1])
    points = np.random.default_rng(2).uniform(-1, 1, (50, 3))
    nearest = np.linalg.norm(points[:, None] - circle, axis=2).min(axis=1)
    np.testing.assert_allclose(edge_distance(disc, points.T), nearest, atol=1e-4)


def test_corners_lie_at_the_half_widths() -> None:
    box = Cuboid("box", np.array([1.0, 2.0, 3.0]), TURNED, (0.1, 0.2, 0.3))
    local = (box.corners - box.centre) @ TURNED.T
    np.testing.assert_allclose(np.abs(local), np.tile([0.1, 0.2, 0.3], (8, 1)), atol=1e-15)
    assert len(np.unique(np.sign(local), axis=0)) == 8


@pytest.mark.parametrize(
    "offset, expected",
    [
        ((0.0, 0.0, 0.02), 0.02),  # face to face
        ((0.13, 0.0, 0.04), 0.05),  # beside an edge: 3-4-5
        ((0.102, 0.103, 0.006), 0.007),  # diagonal to a corner: 2-3-6-7
        ((0.1, 0.0, 0.0), 0.0),  # edges meet
        ((0.03, 0.02, 0.0), 0.0),  # one plane, overlapping
    ],
)
def test_separation_of_plates(offset: tuple[float, float, float], expected: float) -> None:
    first = Rectangle("first", np.zeros(3), np.eye(3), (0.05, 0.05))
    second = Rectangle("second", np.array(offset), np.eye(3), (0.05, 0.05))
    assert separation(first, second) == pytest.approx(expected, abs=1e-12)


def test_separation_of_crossing_and_of_nested_bodies_is_zero() -> None:
    plate = Rectangle("plate", np.zeros(3), np.eye(3), (0.05, 0.05))
    upright = Rectangle("upright", np.zeros(3), AxisRotation((1, 0, 0), 90).matrix().T, (0.02, 0.02))
    box = Cuboid("box", np.zeros(3), TURNED, (0.2, 0.2, 0.2))
    assert separation(plate, upright) == pytest.approx(0, abs=1e-12)
    assert separation(box, plate) == pytest.approx(0, abs=1e-12)
