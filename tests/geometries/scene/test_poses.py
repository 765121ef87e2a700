"""Rotations and poses, readings and targets of a scene, also those that it leaves out."""

from __future__ import annotations

import math

import numpy as np
import pytest

from geometries.scene.poses import AxisRotation, Pose, QuaternionRotation
from geometries.scene.readings import readings, targets
from geometries.scene.scene import Link, Object, Plate, Reading, Scene, Sensor
from geometries.scene.shapes import Cuboid, PlateShape


def test_a_quarter_turn_about_z_takes_x_to_y() -> None:
    np.testing.assert_allclose(AxisRotation((0, 0, 2.0), 90.0).matrix() @ [1, 0, 0], [0, 1, 0], atol=1e-15)


@pytest.mark.parametrize("axis", [(1.0, 0.0, 0.0), (1.0, -2.0, 0.5)])
@pytest.mark.parametrize("degrees", [0.0, 17.2, 90.0, 180.0, -250.0])
def test_axis_and_quaternion_give_the_same_rotation(axis: tuple[float, float, float], degrees: float) -> None:
    half = math.radians(degrees) / 2
    x, y, z = 3 * math.sin(half) * np.asarray(axis) / np.linalg.norm(axis)
    quaternion = QuaternionRotation((3 * math.cos(half), x, y, z))
    matrix = AxisRotation(axis, degrees).matrix()
    np.testing.assert_allclose(quaternion.matrix(), matrix, atol=1e-15)
    np.testing.assert_allclose(matrix @ matrix.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(matrix) == pytest.approx(1)


def test_poses_are_chained_from_the_object_to_the_world() -> None:
    turn = AxisRotation((0.0, 0.0, 1.0), 90.0)
    scene = Scene(
        links=(
            Link("arm", "room", Pose((0.0, 0.0, 1.0), turn)),
            Link("room", None, Pose((5.0, 0.0, 0.0), turn)),
        ),
        sensors=(Sensor("s", (Plate((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0)),), link="arm"),),
        objects=(Object("o", PlateShape((1.0, 1.0)), link="arm", pose=Pose((1.0, 0.0, 0.0))),),
    )
    rotation, translation = scene.pose_of_object("o")
    np.testing.assert_allclose(rotation, np.diag([-1.0, -1.0, 1.0]), atol=1e-15)
    np.testing.assert_allclose(translation, [4, 0, 1], atol=1e-15)
    ((corner, edge_u, edge_v),) = scene.sensor_rectangles("s")
    np.testing.assert_allclose([corner, edge_u, edge_v], [[5, 0, 1], [-1, 0, 0], [0, -2, 0]], atol=1e-15)


def test_a_sensor_gives_two_triangles_for_each_of_its_plates_and_stands_before_the_objects() -> None:
    plate = Plate((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0))
    scene = Scene(sensors=(Sensor("s", (plate, plate)),), objects=(Object("o", PlateShape((1.0, 1.0))),))
    conductors = scene.conductors()
    assert list(conductors) == ["s", "o"]
    assert conductors["s"].shape == (4, 3, 3)
    np.testing.assert_allclose(
        conductors["s"][:2],
        [[(0, 0, 0), (1, 0, 0), (1, 2, 0)], [(0, 0, 0), (1, 2, 0), (0, 2, 0)]],
    )


def test_a_dielectric_body_is_no_conductor() -> None:
    scene = Scene(objects=(Object("o", PlateShape((1.0, 1.0)), relative_permittivity=4.0),))
    assert not scene.conductors()


CUBE = Cuboid((1.0, 1.0, 1.0))
PLATE = Plate((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
SENSORS = (Sensor("front", (PLATE,)), Sensor("back", (PLATE,)))
HAND = Object("hand", CUBE, potential="floating")
GUARD = Object("guard", CUBE, potential="electrode")
GLASS = Object("glass", CUBE, relative_permittivity=5.0)


def test_a_scene_without_readings_has_one_for_every_sensor() -> None:
    scene = Scene(sensors=SENSORS, objects=(GUARD,))
    assert readings(scene) == (Reading("front", "front", ("front",)), Reading("back", "back", ("back",)))


def test_a_scene_with_readings_has_those_alone() -> None:
    guarded = Reading("guarded", "front", ("front", "guard"))
    assert readings(Scene(sensors=SENSORS, objects=(GUARD,), readings=(guarded,))) == (guarded,)


def test_the_threshold_is_five_times_the_noise_unless_it_is_given() -> None:
    scene = Scene(
        sensors=SENSORS,
        readings=(Reading("a", "front", ("front",), 2e-15), Reading("b", "front", ("front",), 2e-15, 3e-15)),
    )
    assert [reading.threshold for reading in readings(scene)] == [5 * 2e-15, 3e-15]


def test_without_a_mark_every_object_is_a_target_but_electrodes() -> None:
    assert targets(Scene(objects=(HAND, GUARD, GLASS))) == (True, False, True)


def test_with_a_mark_only_the_marked_objects_are_targets() -> None:
    marked = Object("hand", CUBE, potential="floating", target=True)
    assert targets(Scene(objects=(marked, GUARD, GLASS))) == (True, False, False)
