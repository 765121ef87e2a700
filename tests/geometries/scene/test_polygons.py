"""Polygons: triangles that cover the polygon once; tests/end_to_end compares what the two readers refuse."""

from __future__ import annotations

import math

import numpy as np
import pytest

from geometries.scene.polygons import Point, anticlockwise, defect, ears, turn

L_SHAPE: list[Point] = [(0, 0), (2, 0), (2, 2), (1, 2), (1, 1), (0, 1)]


def area(triangles: list[tuple[Point, Point, Point]]) -> float:
    corners = np.array(triangles)
    (ux, uy), (vx, vy) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    assert (ux * vy - uy * vx > 0).all()
    return float((ux * vy - uy * vx).sum() / 2)


def test_ears_are_clipped_in_the_order_of_the_format() -> None:
    assert ears(L_SHAPE) == [
        ((0, 1), (0, 0), (2, 0)),
        ((2, 0), (2, 2), (1, 2)),
        ((2, 0), (1, 2), (1, 1)),
        ((0, 1), (2, 0), (1, 1)),
    ]


def test_the_vertices_may_be_clockwise() -> None:
    assert anticlockwise(L_SHAPE) == tuple(L_SHAPE)
    assert anticlockwise(L_SHAPE[::-1]) == tuple(L_SHAPE)
    assert area(ears(anticlockwise(L_SHAPE[::-1]))) == 3


def test_vertices_in_the_middle_of_sides_make_no_triangle_without_area() -> None:
    square: list[Point] = [(0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
    assert defect(square) is None and area(ears(square)) == 4


@pytest.mark.parametrize("seed", range(20))
def test_the_triangles_of_random_stars_have_their_area(seed: int) -> None:
    random = np.random.default_rng(seed)
    angles = np.sort(random.uniform(0, 2 * math.pi, 30))
    star = [
        (float(r * math.cos(a)), float(r * math.sin(a))) for a, r in zip(angles, random.uniform(0.1, 1, 30))
    ]
    if np.diff(angles).max() > 3 or defect(star):
        pytest.skip("the star does not go around its centre")
    x, y = np.array(star).T
    expected = float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2)
    assert len(ears(star)) == 28
    assert area(ears(star)) == pytest.approx(expected, rel=1e-12)


def test_turns_are_exact() -> None:
    on = 0.1 + 0.2
    turns = [
        turn((0, 0), (3 * on, 3 * on), (on, y)) for y in (math.nextafter(on, 0), on, math.nextafter(on, 1))
    ]
    assert turns == [-1, 0, 1]
