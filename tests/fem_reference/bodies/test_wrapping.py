"""Wraps: closed surfaces that strictly contain triangles in any state, and reach no other conductor."""

import numpy as np
import pytest

from fem_reference.bodies.polyhedron import polyhedron
from fem_reference.bodies.round_bodies import Sphere
from fem_reference.bodies.distances import distance
from fem_reference.bodies.wrapping import Geometry, Wrap, containing_triangles, wrap
from geometries.common.arrays import Array
from geometries.scene import shapes
from geometries.scene.shapes import Shape

BOX = shapes.Cuboid((0.1, 0.06, 0.04)).triangles()
SENSOR = shapes.PlateShape((0.05, 0.05)).triangles() + [0, 0, 0.03]


def surface(found: Wrap) -> Array:
    """The triangles (n, 3, 3) of a wrap."""
    return np.asarray(found.vertices[found.triangles])


@pytest.mark.parametrize(
    "triangles",
    [
        pytest.param(np.concatenate([BOX, BOX]), id="twice"),
        pytest.param(
            np.where((np.arange(12) % 3 == 0)[:, None, None], BOX[:, ::-1], BOX), id="every third flipped"
        ),
        pytest.param(np.concatenate([BOX, BOX + [0.05, 0.01, 0.01]]), id="two shells that cross"),
        pytest.param(np.concatenate([BOX, BOX[:3, [0, 0, 1]]]), id="triangles without area"),
        pytest.param(BOX[1:], id="with a small hole"),
    ],
)
def test_a_wrap_is_a_solid_that_contains_the_triangles(triangles: Array) -> None:
    """The wrap passes the checks of a clean mesh, holds all corners, and is nowhere farther from them than it is allowed to be."""
    found = wrap([("box", triangles)], SENSOR, Geometry(rtol=2e-2, alpha=0.08))
    solid = polyhedron("wrap", surface(found))
    assert solid.holds(triangles.reshape(-1, 3)).all()
    excess = np.abs(found.vertices).max(axis=0) - np.abs(triangles.reshape(-1, 3)).max(axis=0)
    assert (excess > 0).all() and (excess < 2e-3).all()


def test_a_wrap_does_not_bridge_to_a_sensor_1_cm_away() -> None:
    """Two plates at a right angle, with a sensor in the corner between them: the hollow stays open."""
    corner = np.concatenate(
        [
            shapes.Cuboid((0.2, 0.2, 0.01)).triangles() - [0, 0, 0.005],
            shapes.Cuboid((0.01, 0.2, 0.2)).triangles() + [-0.1, 0, 0.09],
        ]
    )
    sensor = shapes.PlateShape((0.02, 0.02)).triangles() + [-0.075, 0, 0.01]
    found = wrap([("corner", corner)], sensor, Geometry(rtol=2e-2))
    probe = Sphere("sensor", np.array([-0.075, 0, 0.01]), 0.009)
    assert distance(found, probe) > 0
    assert not found.holds(sensor.reshape(-1, 3)).any()


def test_a_wrap_is_coarser_where_what_has_another_potential_is_far() -> None:
    """A rod with slots 1 cm wide along it, and a sensor at one end: slots there are followed, those at the other end are closed."""
    ribs = [shapes.Cuboid((0.01, 0.05, 0.05)).triangles() + [x, 0, 0] for x in np.arange(0, 0.6, 0.02)]
    rod = np.concatenate([*ribs, shapes.Cuboid((0.6, 0.05, 0.01)).triangles() + [0.29, 0, -0.025]])
    found = wrap([("rod", rod)], SENSOR - [0, 0, 0.002], Geometry(rtol=2e-2))
    in_slots = np.array([[0.01, 0, 0.024], [0.03, 0, 0.024], [0.55, 0, 0.015], [0.57, 0, 0.015]])
    assert found.holds(in_slots).tolist() == [False, False, True, True]
    fine = np.count_nonzero(found.vertices[:, 0] < 0.1)
    assert fine / 0.1 > 2 * (len(found.vertices) - fine) / 0.5


def test_a_wrap_knows_which_body_is_where() -> None:
    found = wrap([("left", BOX), ("right", BOX + [0.05, 0.01, 0.01])], SENSOR, Geometry(rtol=2e-2))
    assert found.members == ("left", "right") and found.name == "left"
    assert found.samples[found.labels == 0, 0].max() == pytest.approx(0.05)
    assert found.samples[found.labels == 1, 0].max() == pytest.approx(0.1)


def test_a_ball_of_40000_triangles_is_wrapped_in_a_tenth_of_them() -> None:
    ball = shapes.Sphere(0.05, 202).triangles()
    found = wrap([("ball", np.concatenate([ball, ball[:7]]))], SENSOR + [0, 0, 0.04], Geometry(rtol=2e-2))
    assert len(ball) > 40_000 and 100 < len(found.triangles) < 4000
    assert np.linalg.norm(surface(found).mean(axis=1), axis=1).min() > 0.0499


@pytest.mark.parametrize(
    "shape",
    [shapes.Sphere(0.3), shapes.Cylinder(0.3, 1.0), shapes.Cone(0.3, 1.0), shapes.Arc(0.5, 1.0, 0.2, 250)],
    ids=lambda shape: type(shape).__name__,
)
def test_the_triangles_of_a_round_body_contain_it(shape: Shape) -> None:
    """Points of the surface, moved inwards by 1e-6, are inside; nothing is much larger than the body."""
    outer = polyhedron("outer", containing_triangles(shape, 1e-3))
    surface_points = shape.triangles().reshape(-1, 3)
    inside = np.zeros(3)
    if isinstance(shape, shapes.Arc):
        around = np.arctan2(surface_points[:, 1], surface_points[:, 0])
        around *= 1 - 1e-6
        middle = (shape.inner_radius + shape.outer_radius) / 2
        inside = middle * np.column_stack([np.cos(around), np.sin(around), 0 * around])
    assert outer.holds(surface_points + 1e-6 * (inside - surface_points)).all()
    assert np.ptp(outer.vertices, axis=0) == pytest.approx(np.ptp(shape.triangles(), axis=(0, 1)), rel=1e-2)


def test_a_wrap_tells_which_hollows_it_closes_and_can_open_them() -> None:
    """A square tube of 8 cm, open at both ends, is closed by every alpha above half of that, also by twice as much."""
    sides = [
        shapes.PlateShape((0.08, 0.4)).triangles() @ turn
        + 0.04 * np.array([[0, 0, 1], [0, 0, -1], [1, 0, 0], [-1, 0, 0]])[k]
        for k, turn in enumerate([np.eye(3), np.eye(3), np.eye(3)[[2, 1, 0]], np.eye(3)[[2, 1, 0]]])
    ]
    tube = [("tube", np.concatenate(sides))]
    nothing = np.empty((0, 3, 3))
    closed = wrap(tube, nothing, Geometry(rtol=2e-2, alpha=0.06))
    middle = np.zeros((1, 3))
    assert closed.holds(middle).all() and 0.03 < closed.closes < 0.045
    opened = wrap(tube, nothing, Geometry(rtol=2e-2, alpha=0.06).opened([closed]))
    assert not opened.holds(middle).any() and opened.closes < 0.6 * closed.closes
    assert wrap([("box", BOX)], nothing, Geometry(rtol=2e-2, alpha=0.06)).closes == 0
