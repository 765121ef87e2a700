"""Distances between bodies of any shape and between triangles, their contacts, and which of them contain others."""

import time

import numpy as np
import pytest

from fem_reference.bodies.distances import Piece, _piece_distance, distance, holds, touch_with_faces
from fem_reference.bodies.polyhedron import polyhedron
from fem_reference.bodies.round_bodies import Arc, Cone, Cylinder, Ellipsoid, Sphere, Swept
from fem_reference.bodies.shapes import SHEETS, Body, Cuboid, Disc, Rectangle, Soup, separation
from fem_reference.bodies.triangle_distances import soup_distance
from fem_reference.mesh.body_distances import (
    ClosedFormBody,
    curvature_radius,
    edge_distance,
    surface_distance,
)
from geometries.common.arrays import Array
from geometries.scene import shapes
from geometries.scene.poses import AxisRotation
from tests.fem_reference.problems import BODIES, CENTRE, L_SHAPE, ORIGIN, PLATE, TURNED, plate, polygon

LYING = AxisRotation((1.0, 0.0, 0.0), 90.0).matrix().T
UPSIDE_DOWN = AxisRotation((1.0, 0.0, 0.0), 180.0).matrix().T
SHEET = polygon("L", L_SHAPE, CENTRE, TURNED)


def above(height: float) -> np.ndarray:
    return np.array([0.0, 0.0, height])


def outside(body: Body, points: Array) -> tuple[Array, Array]:
    """The points that are not inside of the body, and their distances from it."""
    balls = [Sphere("point", point, 1e-9) for point in points]
    balls = [ball for ball in balls if not holds(body, ball)]
    return np.array([ball.centre for ball in balls]), np.array([distance(body, ball) for ball in balls])


@pytest.mark.parametrize(
    "body, expected",
    [
        (Sphere("sphere", np.array([0.8, 0, 0.4]), 0.2), 0.3),  # 3-4-5 from the edge
        (Cylinder("standing", above(1.0), np.eye(3), 0.3, 1.0), 0.5),
        (Cylinder("lying", above(1.0), LYING, 0.3, 1.0), 0.7),
        (Cone("tip down", above(1.0), UPSIDE_DOWN, 0.3, 1.0), 0.5),
        # The ends of the arc are nearest, beside its axis.
        (Arc("arc", np.array([2.0, 0, 0]), np.eye(3), 0.5, 1.0, 0.2, np.pi / 2), 1.5),
        (Sphere("crossing", above(0.1), 0.2), 0.0),
        (Ellipsoid("standing", above(1.0), np.eye(3), (0.1, 0.2, 0.4)), 0.6),
        (Ellipsoid("lying", above(1.0), LYING, (0.1, 0.2, 0.4)), 0.8),
        (Swept("capsule", above(1.0), np.eye(3), (0.0, 0.0, 0.3), 0.2), 0.5),
        (Swept("lying capsule", above(1.0), LYING, (0.0, 0.0, 0.3), 0.2), 0.8),
        # 3-4-5 from the edge.
        (Swept("rounded", np.array([0.9, 0, 0.5]), np.eye(3), (0.1, 0.2, 0.1), 0.3), 0.2),
        (Disc("disc", np.array([1.0, 0, 0.4]), np.eye(3), 0.2), 0.5),
    ],
)
def test_distance_to_a_plate(body: Body, expected: float) -> None:
    assert distance(PLATE, body) == pytest.approx(expected, rel=1e-5, abs=1e-12)
    assert distance(body, PLATE) == pytest.approx(expected, rel=1e-5, abs=1e-12)


def test_a_ring_has_a_hole() -> None:
    """The distance to a ball in the middle of the hole is the difference of the radii, or less by at most ARC_TOLERANCE."""
    ring = Arc("ring", np.zeros(3), TURNED, 0.5, 1.0, 0.2, np.pi)
    found = distance(ring, Sphere("ball", np.zeros(3), 0.2))
    assert 0.3 - 1e-4 * ring.size <= found <= 0.3


@pytest.mark.parametrize("seed", range(20))
def test_the_distance_of_an_ellipsoid_and_a_plane_is_that_of_its_lowest_point(seed: int) -> None:
    random = np.random.default_rng(seed)
    semi_axes = tuple(random.uniform(0.02, 0.3, 3).tolist())
    axes = AxisRotation(tuple(random.normal(size=3).tolist()), random.uniform(0, 180)).matrix()
    reach = float(np.linalg.norm(np.array(semi_axes) * axes[:, 2]))
    body = Ellipsoid("ellipsoid", above(reach + 0.1), axes, semi_axes)  # type: ignore[arg-type]
    assert distance(PLATE, body) == pytest.approx(0.1, rel=1e-5)


def test_the_hollow_of_a_polygon_is_empty() -> None:
    hollow, inside = (CENTRE + np.array(place) @ TURNED for place in ([0.5, 1.5, 0.0], [0.5, 0.5, 0.3]))
    assert distance(SHEET, Sphere("ball", hollow, 0.2)) == pytest.approx(0.3, rel=1e-5)
    assert distance(SHEET, Sphere("ball", inside, 0.2)) == pytest.approx(0.1, rel=1e-5)
    assert not holds(SHEET, Sphere("ball", inside, 0.01))


def test_a_mesh_is_as_far_as_the_solid_it_describes() -> None:
    cuboid = Cuboid("cuboid", CENTRE, TURNED, (0.1, 0.2, 0.3))
    mesh = polyhedron("mesh", shapes.Cuboid((0.2, 0.4, 0.6)).triangles() @ TURNED + CENTRE)
    cylinder = Cylinder("cylinder", np.array([1.0, 0.5, 0.2]), LYING, 0.2, 0.7)
    assert distance(mesh, cylinder) == pytest.approx(distance(cuboid, cylinder), rel=1e-5)
    assert distance(mesh, mesh) == 0


def test_a_large_mesh_is_as_far_from_a_round_body_as_its_nearest_triangle() -> None:
    """Of the 40,000 triangles few are looked at: once so many were that it took seconds."""
    hand = Swept("hand", np.zeros(3), np.eye(3), (0.01, 0.03, 0.08), 0.01)
    shift = np.array([0.07, 0.05, 0.12])
    ball = shapes.Sphere(0.05, 202).triangles() + shift
    start = time.process_time()
    found = distance(Soup("ball", ball, ""), hand)
    assert time.process_time() - start < 2
    assert found == distance(hand, Soup("ball", ball, ""))
    centre = np.linalg.norm(shift - [0.01, 0.03, 0.08])
    assert found == pytest.approx(centre - 0.05 - 0.01, abs=2e-5)


@pytest.mark.parametrize("body", BODIES, ids=lambda body: f"{body.name}")
def test_the_distance_given_to_gmsh_is_the_distance(body: ClosedFormBody) -> None:
    """The distance is right outside of the body. Behind the axis of a narrow arc, where it does not matter, it may be too small; that to an
    ellipsoid is one of first order."""
    points, true = outside(
        body, np.random.default_rng(1).uniform(-3, 3, (15 if isinstance(body, Arc) else 60, 3))
    )
    ratio = surface_distance(body, points.T) / true
    least, most = 0.999, 1.001
    if isinstance(body, Arc) and body.half_angle < np.pi / 2:
        least = 0.5
    if isinstance(body, Ellipsoid):
        least, most = 0.3, 1.7
    assert ratio.max() < most and ratio.min() > least


def test_the_distance_of_an_ellipsoid_given_to_gmsh_is_exact_to_first_order_at_its_surface() -> None:
    ellipsoid = Ellipsoid("ellipsoid", CENTRE, TURNED, (0.3, 0.5, 1.0))
    directions = np.random.default_rng(4).normal(size=(60, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    # Points on the surface, and their normals.
    surface = directions * ellipsoid.semi_axes
    normals = directions / np.array(ellipsoid.semi_axes)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    for away in (1e-3, -1e-3):
        points = CENTRE + (surface + away * normals) @ TURNED
        np.testing.assert_allclose(surface_distance(ellipsoid, points.T), abs(away), rtol=0.05)
    assert np.isfinite(surface_distance(ellipsoid, CENTRE)).all()


def test_the_radius_of_curvature_of_an_ellipsoid_is_the_smaller_one_at_its_tips() -> None:
    """At the end of the semi-axis a the two radii are b²/a and c²/a."""
    semi_axes = (0.3, 0.5, 1.0)
    ellipsoid = Ellipsoid("ellipsoid", CENTRE, TURNED, semi_axes)
    tips = CENTRE + np.diag(semi_axes) @ TURNED
    expected = [0.5**2 / 0.3, 0.3**2 / 0.5, 0.3**2 / 1.0]
    found = curvature_radius(ellipsoid, tips.T)
    assert found is not None
    np.testing.assert_allclose(found, expected, rtol=1e-6)
    ball = curvature_radius(Ellipsoid("ball", CENTRE, TURNED, (0.4, 0.4, 0.4)), tips.T)
    assert ball is not None
    np.testing.assert_allclose(ball, 0.4, rtol=1e-6)


@pytest.mark.parametrize(
    "body",
    [body for body in BODIES if edge_distance(body, CENTRE) is not None],
    ids=lambda body: f"{body.name}",
)
def test_the_edges_given_to_gmsh_are_on_the_surface(body: ClosedFormBody) -> None:
    """An edge belongs to the surface, so that it is never nearer than the surface; and the distance is 0 at points of the edges."""
    points = np.random.default_rng(2).uniform(-3, 3, (200, 3))
    found = edge_distance(body, points.T)
    assert found is not None
    assert np.all(found >= surface_distance(body, points.T) * (1 - 1e-12))
    if isinstance(body, Arc):
        angles = np.linspace(-body.half_angle, body.half_angle, 7)
        rim = body.outer_radius * np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
        on_edges = body.centre + (rim + [0, 0, -body.height / 2]) @ body.axes
        found = edge_distance(body, on_edges.T)
        assert found is not None and found.max() < 1e-7


BLOCK = Cuboid("block", np.array([0, 0, -0.1]), np.eye(3), (0.5, 0.5, 0.1))
LETTER = ((-0.3, -0.3), (0.3, -0.3), (0.3, 0.0), (0.0, 0.0), (0.0, 0.3), (-0.3, 0.3))


@pytest.mark.parametrize(
    "body, expected",
    [
        (Cuboid("slab", above(0.1), np.eye(3), (0.7, 0.2, 0.1)), True),
        (Cylinder("standing", above(0.5), np.eye(3), 0.3, 1.0), True),
        (Cone("on its base", above(0.5), np.eye(3), 0.3, 1.0), True),
        (Cone("on its tip", above(0.5), UPSIDE_DOWN, 0.3, 1.0), False),
        (Cylinder("lying", above(0.3), LYING, 0.3, 1.0), False),
        (Cuboid("sunk in", above(0.09), np.eye(3), (0.7, 0.2, 0.1)), False),
        (Sphere("ball", above(0.2), 0.2), False),
        (Disc("disc", ORIGIN, np.eye(3), 0.3), True),
        (Disc("overhanging disc", ORIGIN, np.eye(3), 0.8), True),
        (Disc("disc below", above(-0.2), np.eye(3), 0.3), True),
        (Disc("standing disc", above(0.3), LYING, 0.3), False),
        (Disc("disc sunk in", above(-0.01), np.eye(3), 0.3), False),
        (polygon("letter", LETTER, ORIGIN, np.eye(3)), True),
        (polygon("letter in it", LETTER, above(-0.1), np.eye(3)), False),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_bodies_touch_with_plane_faces_or_not(body: Body, expected: bool) -> None:
    """Solids and a plate, sheets and a block: of two sheets none is dielectric."""
    if isinstance(body, SHEETS):
        assert touch_with_faces(body, BLOCK) is expected
        assert not touch_with_faces(BLOCK, body)
    else:
        assert touch_with_faces(PLATE, body) is expected


def test_a_solid_contains_a_body_inside_it() -> None:
    small = Sphere("small", CENTRE, 0.05)
    for outer in (
        Sphere("ball", CENTRE, 0.3),
        Cuboid("box", CENTRE, TURNED, (0.1, 0.2, 0.3)),
        polyhedron("mesh", shapes.Cuboid((0.2, 0.4, 0.6)).triangles() @ TURNED + CENTRE),
    ):
        assert holds(outer, small) and not holds(small, outer)
        assert not holds(outer, Sphere("elsewhere", CENTRE + 1, 0.05))
    assert not holds(PLATE, small)


ANGLE = np.linspace(0, 2 * np.pi, 4001)[:, None]


@pytest.mark.parametrize(
    "body, outline",
    [
        (Rectangle("rectangle", CENTRE, TURNED, (0.5, 0.2)), None),
        (SHEET, None),
        (Disc("disc", CENTRE, TURNED, 0.4), 0.4 * (np.cos(ANGLE) * TURNED[0] + np.sin(ANGLE) * TURNED[1])),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_the_edge_distance_of_a_sheet_is_the_distance_to_its_outline(
    body: ClosedFormBody, outline: Array | None
) -> None:
    """The outline is given by its offsets from the centre, or else is that between the corners."""
    if outline is None:
        s = np.linspace(0, 1, 2001)[:, None]
        ends = zip(body.corners, np.roll(body.corners, -1, axis=0))
        outline = np.concatenate([(1 - s) * start + s * end for start, end in ends]) - CENTRE
    points = np.random.default_rng(1).uniform(-1, 1, (50, 3))
    nearest = np.linalg.norm(points[:, None] - CENTRE - outline, axis=2).min(axis=1)
    np.testing.assert_allclose(edge_distance(body, points.T), nearest, atol=1e-4)


SMALL = plate("small", (0.05, 0.05))


@pytest.mark.parametrize(
    "first, second, expected",
    [
        (SMALL, plate("face to face", (0.05, 0.05), 0.0, 0.0, 0.02), 0.02),
        (SMALL, plate("beside an edge: 3-4-5", (0.05, 0.05), 0.13, 0.0, 0.04), 0.05),
        (SMALL, plate("diagonal to a corner: 2-3-6-7", (0.05, 0.05), 0.102, 0.103, 0.006), 0.007),
        (SMALL, plate("edges meet", (0.05, 0.05), 0.1, 0.0, 0.0), 0.0),
        (SMALL, plate("one plane, overlapping", (0.05, 0.05), 0.03, 0.02, 0.0), 0.0),
        (SMALL, Rectangle("crossing", ORIGIN, LYING, (0.02, 0.02)), 0.0),
        (Cuboid("around it", ORIGIN, TURNED, (0.2, 0.2, 0.2)), SMALL, 0.0),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_the_separation_of_plates_and_cuboids(
    first: Rectangle | Cuboid, second: Rectangle | Cuboid, expected: float
) -> None:
    assert separation(first, second) == pytest.approx(expected, abs=1e-12)


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
