"""Planes of symmetry: all are found and no others, and solving one side gives the answer of the whole."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fem_reference.bodies.conductors import Conductors
from fem_reference.bodies.round_bodies import Arc, Cone, Cylinder, Ellipsoid, Sphere, Swept
from fem_reference.bodies.shapes import Body, Cuboid, Disc, Rectangle
from fem_reference.bodies.symmetry import Plane, exchanges, mirror_planes
from fem_reference.mesh.sizing import Sizing
from fem_reference.solve.level import solve_level
from tests.fem_reference.problems import conductors_of
from tests.fem_reference.problems import plate as plate_at

SENSOR = plate_at("sensor", (0.5, 0.3))
LEFT, RIGHT = (plate_at("sensor", (0.5, 0.3), x, 0.2, 0) for x in (-0.6, 0.6))
TURNED = Rotation.from_euler("xyz", [0.3, -0.8, 1.9]).as_matrix()


def plate(x: float, y: float, z: float, half_widths: tuple[float, float] = (0.4, 0.2)) -> Rectangle:
    return plate_at("target", half_widths, x, y, z)


def planes(*bodies: Body, owner: list[int] | None = None) -> tuple[Plane, ...]:
    return mirror_planes(bodies, owner or list(range(len(bodies))))


@pytest.mark.parametrize(
    "target, number",
    [
        (plate(0, 0, 0.2), 2),
        (plate(0.1, 0, 0.2), 1),
        (plate(0.1, 0.1, 0.2), 0),
        (plate(1.2, 0, 0), 1),
        (plate(1.2, 0.9, 0), 0),
        (Sphere("target", np.array([0, 0, 0.9]), 0.3), 2),
        (Cylinder("target", np.array([0, 0, 0.9]), np.eye(3), 0.3, 0.2), 2),
        (Cylinder("target", np.array([0.7, 0, 0.9]), np.eye(3)[[1, 2, 0]], 0.3, 0.2), 1),
        (Cone("target", np.array([0, 0, 0.9]), np.eye(3)[[1, 2, 0]], 0.3, 0.2), 1),
        (Arc("target", np.array([0, 0, 0.9]), np.eye(3), 0.2, 0.3, 0.1, 0.5), 1),
        (Ellipsoid("target", np.array([0, 0, 0.9]), np.eye(3), (0.2, 0.3, 0.1)), 2),
        (Ellipsoid("target", np.array([0, 0, 0.9]), TURNED, (0.2, 0.3, 0.1)), 0),
        (Swept("target", np.array([0, 0, 0.9]), np.eye(3), (0.0, 0.0, 0.1), 0.1), 2),
        (Swept("target", np.array([0.4, 0, 0.9]), np.eye(3)[[1, 2, 0]], (0.1, 0.0, 0.2), 0.1), 1),
        (Disc("target", np.array([0.4, 0, 0.9]), np.eye(3), 0.2), 1),
    ],
)
def test_the_planes_of_a_sensor_and_a_target(target: Body, number: int) -> None:
    assert len(planes(SENSOR, target)) == number


def test_a_single_cube_has_three_planes_and_they_are_at_right_angles() -> None:
    found = planes(Cuboid("cube", np.zeros(3), TURNED, (0.5, 0.5, 0.5)))
    normals = np.array([plane.normal for plane in found])
    np.testing.assert_allclose(normals @ normals.T, np.eye(3), atol=1e-12)


def test_squares_on_a_diagonal_share_the_diagonal_plane() -> None:
    (found,) = planes(plate_at("sensor"), plate(0.4, 0.4, 0.2, (0.3, 0.3)))
    np.testing.assert_allclose(np.abs(found.normal), [np.sqrt(0.5), np.sqrt(0.5), 0])


def test_two_plates_of_one_sensor_may_be_mirrored_into_each_other_and_two_sensors_are_exchanged() -> None:
    target, rows = plate(0, 0, 0.2), ["row"] * 3
    assert len(planes(LEFT, RIGHT, target, owner=[0, 0, 1])) == 1
    assert planes(LEFT, RIGHT, target, owner=[0, 1, 2]) == ()
    assert exchanges([LEFT, RIGHT, target], [0, 1, 2], rows) == ((1, 0, 2),)
    assert exchanges([LEFT, RIGHT, target], [0, 0, 1], rows[:2]) == ()
    assert exchanges([LEFT, RIGHT, plate(0.01, 0, 0.2)], [0, 1, 2], rows) == ()


def test_bodies_of_two_kinds_are_not_exchanged() -> None:
    balls = [Sphere("ball", np.array([x, 0, 0.9]), 0.3) for x in (-0.5, 0.5)]
    bodies = [SENSOR, *balls]
    assert exchanges(bodies, [0, 1, 2], ["row", "floating", "floating"]) == ((0, 2, 1),)
    assert exchanges(bodies, [0, 1, 2], ["row", "row", "floating"]) == ()


def test_a_room_that_is_not_mirrored_allows_no_exchange() -> None:
    balls = [Sphere("ball", np.array([x, 0, 0]), 0.3) for x in (-0.5, 0.5)]
    centred, aside = (Cuboid("room", np.array([x, 0, 0]), np.eye(3), (2.0, 2.0, 2.0)) for x in (0, 0.1))
    assert exchanges(balls, [0, 1], ["row", "row"], centred) == ((1, 0),)
    assert exchanges(balls, [0, 1], ["row", "row"], aside) == ()


def test_a_set_up_a_little_off_its_mirror_image_has_no_plane() -> None:
    assert len(planes(SENSOR, plate(1e-7, 1e-7, 0.2))) == 0


def problem_of(target: Body) -> Conductors:
    turned = [
        Rectangle("sensor", np.ones(3), TURNED.T, (0.5, 0.3)),
        Rectangle("target", np.ones(3) + TURNED @ target.corners.mean(axis=0), TURNED.T, (0.4, 0.2)),
    ]
    return conductors_of(turned)


@pytest.mark.parametrize(
    "target, number", [(plate(0, 0, 0.3), 2), pytest.param(plate(1.2, 0, 0), 1, marks=pytest.mark.night)]
)
def test_one_side_gives_the_answer_of_the_whole(target: Body, number: int) -> None:
    """On meshes of the same fineness the bounds overlap, and one side has its share of the unknowns."""
    problem = problem_of(target)
    found = problem.mirror_planes
    assert len(found) == number
    whole, side = (solve_level(problem, 1.0, Sizing(), "estimate", used) for used in ((), found))
    assert whole.bounds is not None and side.bounds is not None
    one, other = whole.bounds.interval, side.bounds.interval
    assert np.all(one.lower <= other.upper) and np.all(other.lower <= one.upper)
    np.testing.assert_allclose(side.maxwell, whole.maxwell, rtol=3e-3)
    np.testing.assert_allclose(side.delta_self, whole.delta_self, rtol=5e-3)
    assert side.unknowns < whole.unknowns * 0.75**number
