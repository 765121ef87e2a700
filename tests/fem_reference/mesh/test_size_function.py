"""The sizes of the cells: compiled code gives what numpy gives of the same formulas, gaps that are left out set them nowhere, and
they follow the accuracy that was asked for."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fem_reference.bodies.distances import distance
from fem_reference.bodies.polyhedron import polyhedron
from fem_reference.bodies.round_bodies import Arc, Cone, Cylinder, Ellipsoid, Sphere, Swept
from fem_reference.bodies.shapes import Cuboid, Disc, PlanePolygon, Rectangle
from fem_reference.mesh.body_distances import (
    ClosedFormBody,
    curvature_radius,
    curved_distance,
    edge_distance,
    surface_distance,
    wall_distance,
)
from fem_reference.mesh.size_function import SizeFunction
from fem_reference.mesh.size_rules import Sizing, sizing_for
from fem_reference.mesh.sizing import _in_gap, _is_wide
from fem_reference.mesh.tape import Tape, smallest
from geometries.scene import polygons, shapes
from geometries.scene.poses import AxisRotation

TURNED = AxisRotation((1.0, 2.0, -0.5), 33.0).matrix().T
CENTRE = np.array([0.1, -0.2, 0.3])
CORNER = ((0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (1.0, 2.0), (1.0, 1.0), (0.0, 1.0))
BOX = Cuboid("cuboid", CENTRE, TURNED, (0.2, 0.4, 0.6))
BODIES: list[ClosedFormBody] = [
    BOX,
    Rectangle("plate", CENTRE, TURNED, (0.2, 0.4)),
    Disc("disc", CENTRE, TURNED, 0.7),
    PlanePolygon("polygon", CENTRE, TURNED, np.array(CORNER), np.array(polygons.ears(CORNER))),
    Sphere("sphere", CENTRE, 0.8),
    Ellipsoid("ellipsoid", CENTRE, TURNED, (0.3, 0.5, 1.0)),
    Swept("rounded", CENTRE, TURNED, (0.5, 0.0, 0.8), 0.1),
    Cylinder("cylinder", CENTRE, TURNED, 1.0, 2.0),
    Cone("cone", CENTRE, TURNED, 0.7, 2.0),
    Arc("arc", CENTRE, TURNED, 1.0, 1.6, 0.8, 0.6),
    Arc("ring", CENTRE, TURNED, 1.0, 1.6, 0.8, np.pi),
]
POINTS = np.random.default_rng(1).uniform(-3, 3, (200, 3))


@pytest.mark.parametrize("body", BODIES, ids=lambda body: f"{body.name}")
def test_every_distance_is_the_same_on_a_tape(body: ClosedFormBody) -> None:
    for formula in (surface_distance, edge_distance, curvature_radius, curved_distance):
        expected = formula(body, POINTS.T)
        if isinstance(expected, np.ndarray):
            np.testing.assert_allclose(
                SizeFunction(formula(body, Tape().point))(POINTS), expected, rtol=1e-13
            )


def test_any_step_may_be_the_result_and_equal_steps_are_recorded_once() -> None:
    tape = Tape()
    x, y, _ = tape.point
    total = x + y
    smallest([2.0 - total, -(x + y) / 3])
    assert len(tape.steps) == len(set(tape.steps))
    np.testing.assert_array_equal(SizeFunction(total)(POINTS), POINTS[:, 0] + POINTS[:, 1])
    inside = wall_distance(Cuboid("room", np.zeros(3), np.eye(3), (4.0, 5.0, 6.0)), tape.point)
    np.testing.assert_allclose(SizeFunction(inside)(np.array([[3.5, -1.0, 2.0]])), 0.5)


def test_what_a_tape_cannot_record_is_an_error() -> None:
    with pytest.raises(TypeError):
        np.sin(Tape().point[0])


def test_the_distance_from_triangles_is_that_from_the_solid_they_bound() -> None:
    """The box in many triangles; a tape with several surfaces finds each, and segments are triangles with two equal corners."""
    parts = shapes.Cuboid((0.4, 0.8, 1.2)).triangles()
    for _ in range(3):
        middles = [(parts[:, k] + parts[:, (k + 1) % 3]) / 2 for k in range(3)]
        thirds = [np.stack([parts[:, k], middles[k], middles[k - 1]], axis=1) for k in range(3)]
        parts = np.concatenate([*thirds, np.stack(middles, axis=1)])
    solid = polyhedron("box", parts @ TURNED + CENTRE)
    outside = POINTS[surface_distance(BOX, POINTS.T) > 0]
    tape = Tape()
    surface = tape.distance(solid.vertices[solid.triangles])
    edges = tape.distance(solid.vertices[solid.edges][:, [0, 1, 1]])
    np.testing.assert_allclose(SizeFunction(surface)(outside), surface_distance(BOX, outside.T), rtol=1e-9)
    np.testing.assert_allclose(SizeFunction(edges)(outside), edge_distance(BOX, outside.T), rtol=1e-9)


def test_the_least_sum_of_distance_and_offset_is_found_among_all_triangles() -> None:
    random = np.random.default_rng(2)
    places, offsets = random.uniform(-2, 2, (300, 3)), random.exponential(0.5, 300)
    found = SizeFunction(Tape().distance(np.repeat(places[:, None], 3, axis=1), offsets))(POINTS)
    sums = np.linalg.norm(POINTS[:, None] - places, axis=2) + offsets
    np.testing.assert_allclose(found, sums.min(axis=1), rtol=1e-12)


def test_in_a_wide_gap_the_growth_from_edges_is_smaller_everywhere() -> None:
    random = np.random.default_rng(1)
    sizing, left_out = Sizing(growth=0.6), 0
    for _ in range(200):
        axes = Rotation.random(2, random_state=int(random.integers(1 << 30))).as_matrix()
        body: Rectangle | Cuboid = Cuboid("body", np.zeros(3), axes[0], tuple(random.uniform(0.1, 1, 3)))
        if random.random() < 0.5:
            body = Rectangle("body", np.zeros(3), axes[0], tuple(random.uniform(0.1, 1, 2)))
        other = Cuboid("other", random.uniform(-4, 4, 3), axes[1], (0.3, 0.5, 0.2))
        ratio = _in_gap(body, other, sizing)
        if not _is_wide(body, distance(body, other), ratio, sizing):
            continue
        left_out += 1
        points = np.concatenate([random.uniform(-5, 5, (500, 3)), random.normal(size=(500, 3))])
        edges = edge_distance(body, points.T)
        assert edges is not None
        grown = sizing.edge * body.size + sizing.growth * edges
        in_gap = ratio * (surface_distance(body, points.T) + surface_distance(other, points.T))
        assert np.all(grown <= in_gap)
    assert left_out > 50


def test_cells_grow_no_faster_where_more_accuracy_is_asked_for() -> None:
    growths = [sizing_for(rtol, 1.0).growth for rtol in (1e-1, 1e-3, 9e-4, 1e-4)]
    assert growths == sorted(growths, reverse=True)
    assert growths[0] == growths[1] > growths[2] > growths[3]


def test_what_is_asked_coarsely_is_meshed_coarsely() -> None:
    coarse, fine = sizing_for(2e-2, 1.0), sizing_for(1e-2, 1.0)
    assert coarse.curvature > fine.curvature and coarse.far > fine.far
    assert coarse.edge == fine.edge and coarse.edge_in_gap == fine.edge_in_gap
