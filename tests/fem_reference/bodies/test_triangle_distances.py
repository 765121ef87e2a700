"""Distances between triangles in any state agree with those of convex pieces, and are fast for many triangles."""

from __future__ import annotations

import time

import numpy as np
import pytest

from fem_reference.bodies.distances import Piece, _piece_distance
from fem_reference.bodies.triangle_distances import soup_distance
from geometries.scene import shapes


def test_the_distance_of_two_triangles_is_that_of_their_convex_hulls() -> None:
    random = np.random.default_rng(1)
    first = random.normal(size=(100, 3, 3))
    second = random.normal(size=(100, 3, 3)) + 1.5 * random.normal(size=(100, 1, 3))
    for a, b in zip(first, second):
        found = soup_distance(a[None], b[None])
        assert found == pytest.approx(_piece_distance(Piece(a), Piece(b)), rel=2e-6, abs=1e-12)


@pytest.mark.parametrize("shift, expected", [((3.0, 0, 0), 1.0), ((2.0, 0, 0), 0.0), ((0.5, 0.1, 0), 0.0)])
def test_the_distance_of_meshes_is_that_of_the_nearest_triangles(
    shift: tuple[float, float, float], expected: float
) -> None:
    ball, box = shapes.Sphere(1.0, 60).triangles(), shapes.Cuboid((2.0, 2.0, 2.0)).triangles() + shift
    assert soup_distance(ball, box) == pytest.approx(expected, abs=1e-12)
    assert soup_distance(box, ball) == pytest.approx(expected, abs=1e-12)


def test_a_mesh_inside_another_is_as_far_as_their_surfaces() -> None:
    ball = shapes.Sphere(1.0, 40).triangles()
    assert soup_distance(ball, 0.5 * ball) == pytest.approx(0.5 * np.cos(np.pi / 40) ** 2, rel=1e-2)


def test_a_triangle_without_area_is_as_far_as_its_sides() -> None:
    """It once counted as meeting everything."""
    needle = np.array([[[0.0, 0, 0], [1, 0, 0], [0.5, 0, 0]]])
    point = np.zeros((1, 3, 3))
    plate = shapes.PlateShape((1.0, 1.0)).triangles() + [0.5, 0, 0.3]
    assert soup_distance(needle, plate) == pytest.approx(0.3)
    assert soup_distance(plate, point) == pytest.approx(0.3)


def test_long_triangles_that_all_overlap_each_others_balls_take_no_longer() -> None:
    """Two rods of 1200 triangles as long as they are, side by side: once every pair of triangles was looked at closely, for a minute."""
    rod = shapes.Cylinder(0.05, 1.0, 300).triangles()
    start = time.process_time()
    assert soup_distance(rod, rod + [0.1003, 0.0, 0.0]) == pytest.approx(3e-4, rel=1e-6)
    assert time.process_time() - start < 10
