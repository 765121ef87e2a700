"""Remarks: what can be answered, but is probably not what was meant. `tests/end_to_end` compares them with those of the library."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fem_reference.bodies.remarks import remarks
from geometries.scene.poses import Pose
from geometries.scene.scene import Object, Plate, Scene, Sensor
from geometries.scene.shapes import Arc, Array, Cuboid, MeshShape, Shape, Sphere

SENSOR = Sensor("front", (Plate((-0.05, -0.05, 0.0), (0.1, 0.0, 0.0), (0.0, 0.1, 0.0)),))
BOX = Cuboid((0.1, 0.1, 0.1))


def body(name: str, shape: Shape, *place: float) -> Object:
    return Object(name, shape, pose=Pose((place[0], place[1], place[2])))


def mesh(triangles: Array) -> MeshShape:
    return MeshShape("", "", 1.0, triangles)


SOUND = Scene(sensors=(SENSOR,), objects=(body("hand", BOX, 0, 0, 0.1),))


def test_a_sound_scene_has_none() -> None:
    assert remarks(SOUND) == []
    assert remarks(Scene(sensors=(SENSOR,))) == []
    assert remarks(replace(SOUND, sensors=())) == []


def test_what_the_reader_changed_comes_first() -> None:
    assert remarks(replace(SOUND, changes=("it is squared",))) == ["it is squared"]


def test_lengths_that_may_be_in_millimetres() -> None:
    wide = replace(
        SENSOR, plates=(*SENSOR.plates, Plate((100.0, 0.0, 0.0), (40.0, 0.0, 0.0), (0.0, 30.0, 0.0)))
    )
    long = Cuboid((1, 179, 1))
    scene = Scene(sensors=(wide,), objects=(*SOUND.objects, body("arm", long, 300, 0, 0)))
    question = 'is it in millimetres? Then write units = "mm" at the top of the scene'
    assert remarks(scene) == [
        f'sensor "front": plates[1] is 40 m long: {question}',
        f'object "arm" is 179 m long: {question}',
    ]
    scene = replace(SOUND, objects=(body("arm", mesh(long.triangles()), 300, 0, 0),))
    assert remarks(scene) == [
        f'object "arm" is 179 m long: {question}, or scale = 0.001 in the object\'s shape'
    ]


def test_a_scene_that_is_tiny() -> None:
    tiny = Plate((0.0, 0.0, 0.0), (1e-4, 0.0, 0.0), (0.0, 1e-4, 0.0))
    scene = Scene(
        sensors=(replace(SENSOR, plates=(tiny,)),), objects=(body("hand", Sphere(5e-5, 8), 0, 0, 2e-4),)
    )
    (remark,) = remarks(scene)
    assert remark.startswith("all of the scene is 0.00025 m long")
    assert remarks(replace(scene, objects=(*scene.objects, body("box", BOX, 0, 0, 1)))) == []


def test_triangles_that_do_not_count_and_meshes_that_face_inwards() -> None:
    triangles = BOX.triangles()
    line = triangles[0][[0, 0, 1]]
    unclean = np.concatenate([triangles, [triangles[3], line, triangles[3][[1, 0, 2]], line, line]])
    assert remarks(replace(SOUND, objects=(body("hand", mesh(unclean), 0, 0, 0.1),))) == [
        'object "hand": triangles without area: 3, triangles that repeat others: 2; they are left out'
    ]
    (remark,) = remarks(replace(SOUND, objects=(body("hand", mesh(triangles[:, ::-1]), 0, 0, 0.1),)))
    assert remark.startswith('object "hand": its triangles face inwards:')


@pytest.mark.parametrize(
    ("names", "listed"),
    [("a", '"a"'), ("ab", '"a" and "b"'), ("abc", '"a", "b" and "c"'), ("abcde", '"a", "b", "c" and 2 more')],
)
def test_objects_inside_others(names: str, listed: str) -> None:
    inside = [body(name, Sphere(0.01, 8), 0, 0, 0.1) for name in names]
    through = body("through", Sphere(0.01, 8), 0, 0, 0.145)
    assert [
        remark.split(":")[0] for remark in remarks(replace(SOUND, objects=(*SOUND.objects, *inside, through)))
    ] == [f'object "hand" contains {listed}']


def test_what_ends_in_the_surface_is_not_inside() -> None:
    assert (
        remarks(replace(SOUND, objects=(*SOUND.objects, body("die", Cuboid((0.05, 0.05, 0.1)), 0, 0, 0.1))))
        == []
    )


def test_a_ring_does_not_contain_what_is_in_its_hollow() -> None:
    ring = body("ring", Arc(0.05, 0.06, 0.1, 360.0, 24), 0, 0, 0.1)
    assert remarks(replace(SOUND, objects=(ring, body("ball", Sphere(0.01, 8), 0, 0, 0.1)))) == []
