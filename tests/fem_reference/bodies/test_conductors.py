"""Conversion of scenes to bodies: poses, scale, and the scenes that are refused."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest

from fem_reference.bodies.shapes import Cuboid
from fem_reference.bodies.distances import distance
from fem_reference.bodies.round_bodies import Sphere
from fem_reference.bodies.conductors import conductors
from fem_reference.bodies.wrapping import Geometry
from geometries.common.arrays import Array
from geometries.common.errors import InputError
from geometries.scene import shapes
from geometries.scene.reader import loads
from tests import scenes

SENSOR = scenes.sensor("sensor", [[-0.05, -0.05, 0], [0.1, 0, 0], [0, 0.1, 0]])


CUBE = shapes.Cuboid((0.02, 0.02, 0.02)).triangles()
DIELECTRIC = "translation = [0, 0, 0.02]\nmaterial = { relative_permittivity = 4 }"


def target(
    shape: str = '{ type = "plate", size = [0.1, 0.1] }', rest: str = "translation = [0, 0, 0.02]"
) -> str:
    return f'{SENSOR}\n[[object]]\nname = "target"\nshape = {shape}\n{rest}\n'


def mesh_scene(folder: Path, triangles: Array) -> str:
    points = triangles.reshape(-1, 3)
    cells = [("triangle", np.arange(len(points)).reshape(-1, 3))]
    meshio.write(folder / "solid.stl", meshio.Mesh(points, cells))
    return target(f'{{ type = "mesh", file = "{folder / "solid.stl"}" }}', "translation = [0, 0, 0.02]")


def test_sensors_come_first_and_bodies_know_their_conductor() -> None:
    found = conductors(loads(target()))
    assert found.names == ("sensor", "target") and found.sensors == 1 and found.owner == (0, 1)


def test_a_mesh_file_of_a_box_is_a_cuboid(tmp_path: Path) -> None:
    found = conductors(loads(mesh_scene(tmp_path, CUBE))).bodies[1]
    assert isinstance(found, Cuboid) and found.name == "target"


def test_numbers_go_through_sensors_grounded_and_floating_objects() -> None:
    more = scenes.body("grounded", "plate", size=[0.1, 0.1], translation=[0, 0, 0.05])
    found = conductors(loads(target(rest='translation = [0, 0, 0.02]\npotential = "floating"') + more))
    assert found.names == ("sensor", "grounded") and found.floating == ("target",)
    assert found.owner == (0, 1, 2) and [body.name for body in found.bodies][1:] == ["grounded", "target"]


def test_bodies_stand_where_the_scene_puts_them() -> None:
    scene = loads(
        target(
            '{ type = "cuboid", size = [0.02, 0.04, 0.06] }',
            "translation = [0.01, 0.02, 0.1]\nrotation = { axis = [1, 2, 3], degrees = 40 }",
        )
    )
    found = conductors(scene)
    corners = found.bodies[1].corners * found.unit + found.centre
    triangles = scene.conductors()["target"].reshape(-1, 3)
    np.testing.assert_allclose(np.unique(corners.round(12), axis=0), np.unique(triangles.round(12), axis=0))


def test_a_scene_of_twice_the_size_elsewhere_is_the_same_problem() -> None:
    small = conductors(loads(target()))
    large = conductors(
        loads(
            target('{ type = "plate", size = [0.2, 0.2] }', "translation = [0, 0, 0.04]").replace(
                "[-0.05, -0.05, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0]",
                "[-0.1, -0.1, 0], edge_u = [0.2, 0, 0], edge_v = [0, 0.2, 0]",
            )
        )
    )
    assert large.unit == pytest.approx(2 * small.unit, rel=1e-15)
    for one, other in zip(small.bodies, large.bodies):
        np.testing.assert_allclose(one.corners, other.corners, atol=1e-15)


def test_a_dielectric_body_may_touch_with_a_face_and_is_no_conductor() -> None:
    scene = target('{ type = "cuboid", size = [0.1, 0.1, 0.04] }', DIELECTRIC)
    found = conductors(loads(scene + "[medium]\nrelative_permittivity = 2"))
    (body,) = found.dielectrics
    assert found.names == ("sensor",) and found.parts == [[0]]
    assert (body.name, body.relative_permittivity, found.permittivities) == ("target", 4, {1: 2})


@pytest.mark.parametrize(
    "shape",
    [
        '{ type = "cylinder", radius = 0.01, height = 0.02 }',
        '{ type = "cone", radius = 0.01, height = 0.02 }',
        '{ type = "sphere", radius = 0.01 }',
        '{ type = "arc", inner_radius = 0.01, outer_radius = 0.03, height = 0.01, degrees = 100 }',
    ],
)
def test_round_bodies_stand_where_the_scene_puts_them(shape: str) -> None:
    """No vertex of the scene's triangles is outside of the body, and the body's bounding box is no larger than the triangles'."""
    scene = loads(
        target(shape, "translation = [0.01, 0.02, 0.1]\nrotation = { axis = [1, 2, 3], degrees = 40 }")
    )
    found = conductors(scene)
    vertices = (scene.conductors()["target"].reshape(-1, 3) - found.centre) / found.unit
    body = found.bodies[1]
    assert max(distance(body, Sphere("vertex", vertex, 1e-9)) for vertex in vertices[::7]) < 1e-6
    if not isinstance(body, Sphere):
        rotation, translation = scene.pose_of_object("target")
        inscribed = (scene.conductors()["target"].reshape(-1, 3) - translation) @ rotation
        box = (body.corners * found.unit + found.centre - translation) @ rotation
        np.testing.assert_allclose(np.ptp(inscribed, axis=0), np.ptp(box, axis=0), rtol=5e-3)


def test_a_mesh_file_becomes_a_solid(tmp_path: Path) -> None:
    scene = loads(mesh_scene(tmp_path, CUBE))
    found = conductors(scene)
    corners = found.bodies[1].corners * found.unit + found.centre
    triangles = scene.conductors()["target"].reshape(-1, 3)
    np.testing.assert_allclose(np.unique(corners.round(9), axis=0), np.unique(triangles.round(9), axis=0))


def test_a_mesh_that_bounds_no_solid_is_refused_with_file_and_place_where_it_must_not_be_wrapped(
    tmp_path: Path,
) -> None:
    for triangles, words in (
        (CUBE[:-1], "is open at the edge around"),
        (CUBE[:, ::-1], "is inside out around"),
    ):
        with pytest.raises(InputError, match=words) as refused:
            conductors(loads(mesh_scene(tmp_path, triangles)), "scene.toml", geometry=Geometry("exact"))
        assert 'object "target": shape.file' in str(refused.value) and "solid.stl" in str(refused.value)


def test_a_sensor_inside_a_mesh_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match='"sensor" is inside "target"'):
        conductors(loads(mesh_scene(tmp_path, 100 * CUBE)))


def test_plates_of_one_plane_that_do_not_touch_are_solved() -> None:
    assert len(conductors(loads(target(rest="translation = [0.101, 0, 0]"))).bodies) == 2


@pytest.mark.parametrize(
    "text, words",
    [
        (target(rest="translation = [0, 0, 0]"), '"sensor" and "target": the conductors touch or cross'),
        (target(rest="rotation = { axis = [1, 0, 0], degrees = 90 }"), "touch or cross"),
        (target(rest="translation = [0.1, 0, 0]"), "touch or cross"),
        (target('{ type = "cube", size = 1 }', ""), '"sensor" is inside "target"'),
        (target(rest="translation = [0, 0, 1e-5]"), "too narrow to mesh"),
        (target('{ type = "sphere", radius = 0.02 }'), "touch or cross"),
        (target('{ type = "sphere", radius = 0.5 }'), '"sensor" is inside "target"'),
        (target('{ type = "sphere", radius = 0.01999 }'), "too narrow to mesh"),
        (target('{ type = "cylinder", radius = 0.02, height = 0.05 }'), "touch or cross"),
        (
            target('{ type = "plate", size = [1, 1] }', DIELECTRIC),
            'object "target": shape.type: a sheet has no',
        ),
        (target('{ type = "cuboid", size = [0.1, 0.1, 0.05] }', DIELECTRIC), "inside"),
        (target('{ type = "sphere", radius = 0.02 }', DIELECTRIC), "touch elsewhere than with plane faces"),
        (target()[len(SENSOR) :], "nothing to solve"),
        (target(rest='translation = [0, 0, 0]\npotential = "electrode"'), "touch or cross"),
    ],
)
def test_what_cannot_be_solved_is_refused_with_its_name(text: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as refused:
        conductors(loads(text), "scene.toml")
    assert str(refused.value).startswith("scene.toml: ")
