"""Polygons and faces of meshes: triangles that cover them once, whatever their plane; tests/end_to_end compares what the two readers refuse."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from geometries.scene.faces import Surface, divided
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


DART = [(2, 0), (1, 0.2), (1, 2), (0, 0)]
COMB = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 3), (3, 3), (3, 1), (0, 1)]
# A square of 4 around one of 2, whose outline goes to the hole and back from its first corner.
HOLE = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)]
# A square with corners in the middle of two sides.
MIDDLES = [(0, 0), (1, 0), (2, 0), (2, 2), (1, 2), (0, 2)]
# A square of 4 less a quadrilateral of 2 that touches its first corner from within: the corner at that place is no ear.
TOUCHING = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 2), (2, 2), (2, 1)]


def of(outline: list[tuple[float, ...]]) -> Surface:
    points = np.zeros((len(outline), 3))
    points[:, : len(outline[0])] = outline
    return divided(points, [range(len(outline))])


def surface_area(surface: Surface) -> float:
    sides = surface.triangles[:, 1:] - surface.triangles[:, :1]
    return float(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum() / 2)


def normal(surface: Surface) -> np.ndarray:
    sides = surface.triangles[:, 1:] - surface.triangles[:, :1]
    return np.asarray(np.cross(sides[:, 0], sides[:, 1]).sum(axis=0) / 2)


@pytest.mark.parametrize(
    ("outline", "expected"), [(DART, 1.1), (COMB, 10), (HOLE, 12), (MIDDLES, 4), (TOUCHING, 14)]
)
def test_a_face_is_covered_once_from_each_corner_on_and_in_every_plane(
    outline: list[tuple[float, ...]], expected: float
) -> None:
    for first, mirrored, axes in itertools.product(
        range(len(outline)), (1, -1), itertools.permutations(range(3))
    ):
        turned = outline[first:] + outline[:first]
        points = np.zeros((len(outline), 3))
        points[:, :2] = turned[::mirrored]
        surface = divided(points[:, axes], [range(len(outline))])
        assert len(surface.triangles) == len(outline) - 2
        assert surface_area(surface) == pytest.approx(expected, rel=1e-12)
        assert np.linalg.norm(normal(surface)) == pytest.approx(expected, rel=1e-12)
        assert surface.remarks(1) == ()


def test_the_order_is_that_of_the_format() -> None:
    def indices(outline: list[tuple[float, ...]]) -> list[list[int]]:
        found = of(outline).triangles[:, :, :2].tolist()
        return [[outline.index(tuple(corner)) for corner in triangle] for triangle in found]

    assert indices([(0, 0), (2, 0), (2, 2), (1, 3), (0, 2)]) == [[0, 1, 2], [0, 2, 3], [0, 3, 4]]
    assert indices(DART) == [[3, 0, 1], [3, 1, 2]]
    # A vertex in the middle of a side that begins there gives no triangle without area.
    assert indices(MIDDLES) == [[5, 0, 1], [5, 1, 2], [2, 3, 4], [5, 2, 4]]


def test_faces_of_several_sizes_keep_their_order() -> None:
    points = np.array([(*corner, 0.0) for corner in COMB])
    faces = [[0, 1, 2], [0, 1, 6, 7], list(range(8)), [4, 3, 2]]
    whole = divided(points, faces).triangles
    assert whole.tolist() == [t for face in faces for t in divided(points, [face]).triangles.tolist()]


def test_faces_that_bound_no_one_surface_are_remarked_on() -> None:
    bow_tie = of([(0, 0), (1, 1), (1, 0), (0, 1)])
    assert len(bow_tie.triangles) == 2
    assert bow_tie.remarks(1) == (
        "faces whose outline crosses itself: 1; triangles would say which surface is meant",
    )
    # The corners are by turns 0.02 above and below the middle plane.
    bent = of([(0, 0, 0), (1, 0, 0.04), (1, 1, 0), (0, 1, 0.04)])
    assert bent.remarks(0.001) == (
        "faces whose corners are not in one plane: 1, by up to 4e-05 m; triangles would say which surface is meant",
    )
    rounded = of([(0, 0, 0), (1, 0, 0.0005), (1, 1, 0), (0, 1, 0.0005)])
    assert rounded.remarks(1) == ()


def test_faces_without_area_stay() -> None:
    repeated = of([(0, 0), (0, 0), (1, 0), (1, 1), (0, 1)])
    assert len(repeated.triangles) == 3 and surface_area(repeated) == pytest.approx(1)
    assert len(of([(0, 0), (1, 0), (2, 0), (3, 0)]).triangles) == 2
    assert repeated.remarks(1) == of([(0.1, 0.3), (0.2, 0.6), (0.3, 0.9), (0.4, 1.2)]).remarks(1) == ()


@pytest.mark.parametrize("seed", range(5))
def test_random_stars_in_random_planes_have_their_area(seed: int) -> None:
    random = np.random.default_rng(seed)
    angles = 2 * math.pi * (np.arange(20) + random.uniform(0, 0.9, 20)) / 20
    radii = random.uniform(0.1, 1, 20)
    frame = np.linalg.qr(random.normal(size=(3, 3)))[0]
    points = (np.column_stack([radii * np.cos(angles), radii * np.sin(angles), np.ones(20)])) @ frame
    expected = float((radii * np.roll(radii, -1) * np.sin(np.roll(angles, -1) - angles)).sum() / 2)
    assert surface_area(divided(points, [range(20)])) == pytest.approx(expected, rel=1e-9)
