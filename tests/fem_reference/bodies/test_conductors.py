"""Conversion of scenes to bodies: poses, scale, and the scenes that are refused."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fem_reference.bodies.conductors import conductors
from fem_reference.bodies.distances import distance
from fem_reference.bodies.round_bodies import Sphere
from fem_reference.bodies.shapes import Cuboid
from fem_reference.bodies.wrapping import Geometry
from geometries.common.arrays import Array
from geometries.common.errors import InputError
from geometries.scene import meshes, shapes
from geometries.scene.reader import loads
from tests import scenes

CUBE = shapes.Cuboid((0.02, 0.02, 0.02)).triangles()
TURN = {"translation": [0.01, 0.02, 0.1], "rotation": {"axis": [1, 2, 3], "degrees": 40}}
DIELECTRIC = {"material": {"relative_permittivity": 4}}


def square(side: float) -> str:
    """A square sensor."""
    return scenes.sensor("sensor", [[-side / 2, -side / 2, 0], [side, 0, 0], [0, side, 0]])


def target(kind: str = "plate", *, translation: tuple[float, ...] = (0, 0, 0.02), **keys: Any) -> str:
    """A sensor of 10 cm and an object above it, by default a plate of 10 cm."""
    size = {"size": [0.1, 0.1]} if kind == "plate" else {}
    return square(0.1) + scenes.body("target", kind, **{"translation": [*translation], **size, **keys})


def mesh_scene(folder: Path, triangles: Array) -> str:
    meshes.write(triangles, folder / "solid.stl")
    return target("mesh", file=str(folder / "solid.stl"))


def in_metres(text: str) -> tuple[Array, Array]:
    """The corners of the second body of a scene, and the vertices of its triangles."""
    scene = loads(text)
    found = conductors(scene)
    vertices = scene.conductors()["target"].reshape(-1, 3)
    return found.bodies[1].corners * found.unit + found.centre, vertices


def test_sensors_come_first_and_bodies_know_their_conductor() -> None:
    found = conductors(loads(target()))
    assert found.names == ("sensor", "target") and found.sensors == 1 and found.owner == (0, 1)


def test_numbers_go_through_sensors_grounded_and_floating_objects() -> None:
    more = scenes.body("grounded", "plate", size=[0.1, 0.1], translation=[0, 0, 0.05])
    found = conductors(loads(target(potential="floating") + more))
    assert found.names == ("sensor", "grounded") and found.floating == ("target",)
    assert found.owner == (0, 1, 2) and [body.name for body in found.bodies][1:] == ["grounded", "target"]


def test_bodies_stand_where_the_scene_puts_them() -> None:
    corners, vertices = in_metres(target("cuboid", size=[0.02, 0.04, 0.06], **TURN))
    np.testing.assert_allclose(np.unique(corners.round(12), axis=0), np.unique(vertices.round(12), axis=0))


def test_a_scene_of_twice_the_size_elsewhere_is_the_same_problem() -> None:
    small = conductors(loads(target()))
    larger = scenes.body("target", "plate", size=[0.2, 0.2], translation=[0, 0, 0.04])
    large = conductors(loads(square(0.2) + larger))
    assert large.unit == pytest.approx(2 * small.unit, rel=1e-15)
    for one, other in zip(small.bodies, large.bodies):
        np.testing.assert_allclose(one.corners, other.corners, atol=1e-15)


def test_a_dielectric_body_may_touch_with_a_face_and_is_no_conductor() -> None:
    scene = target("cuboid", size=[0.1, 0.1, 0.04], **DIELECTRIC)
    found = conductors(loads(scene + "[medium]\nrelative_permittivity = 2"))
    (body,) = found.dielectrics
    assert found.names == ("sensor",) and found.parts == [[0]]
    assert (body.name, body.relative_permittivity, found.permittivities) == ("target", 4, {1: 2})


@pytest.mark.parametrize(
    "kind, lengths",
    [
        ("cylinder", {"radius": 0.01, "height": 0.02}),
        ("cone", {"radius": 0.01, "height": 0.02}),
        ("sphere", {"radius": 0.01}),
        ("arc", {"inner_radius": 0.01, "outer_radius": 0.03, "height": 0.01, "degrees": 100}),
    ],
)
def test_round_bodies_stand_where_the_scene_puts_them(kind: str, lengths: dict[str, float]) -> None:
    """No vertex of the scene's triangles is outside of the body, and the body's bounding box is no larger than the triangles'."""
    scene = loads(target(kind, **lengths, **TURN))
    found = conductors(scene)
    vertices = (scene.conductors()["target"].reshape(-1, 3) - found.centre) / found.unit
    body = found.bodies[1]
    assert max(distance(body, Sphere("vertex", vertex, 1e-9)) for vertex in vertices[::21]) < 1e-6
    if not isinstance(body, Sphere):
        rotation, translation = scene.pose_of_object("target")
        inscribed = (scene.conductors()["target"].reshape(-1, 3) - translation) @ rotation
        box = (body.corners * found.unit + found.centre - translation) @ rotation
        np.testing.assert_allclose(np.ptp(inscribed, axis=0), np.ptp(box, axis=0), rtol=5e-3)


def test_a_mesh_file_of_a_box_becomes_a_cuboid_where_it_stands(tmp_path: Path) -> None:
    text = mesh_scene(tmp_path, CUBE)
    found = conductors(loads(text)).bodies[1]
    assert isinstance(found, Cuboid) and found.name == "target"
    corners, vertices = in_metres(text)
    np.testing.assert_allclose(np.unique(corners.round(9), axis=0), np.unique(vertices.round(9), axis=0))


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
    assert len(conductors(loads(target(translation=(0.101, 0, 0)))).bodies) == 2


@pytest.mark.parametrize(
    "text, words",
    [
        (target(translation=(0, 0, 0)), '"sensor" and "target": the conductors touch or cross'),
        (target(translation=(0, 0, 0), rotation={"axis": [1, 0, 0], "degrees": 90}), "touch or cross"),
        (target(translation=(0.1, 0, 0)), "touch or cross"),
        (target("cube", size=1), '"sensor" is inside "target"'),
        (target(translation=(0, 0, 1e-5)), "too narrow to mesh"),
        (target("sphere", radius=0.02), "touch or cross"),
        (target("sphere", radius=0.5), '"sensor" is inside "target"'),
        (target("sphere", radius=0.01999), "too narrow to mesh"),
        (target("cylinder", radius=0.02, height=0.05), "touch or cross"),
        (target(size=[1, 1], **DIELECTRIC), 'object "target": shape.type: a sheet has no'),
        (target("cuboid", size=[0.1, 0.1, 0.05], **DIELECTRIC), "inside"),
        (target("sphere", radius=0.02, **DIELECTRIC), "touch elsewhere than with plane faces"),
        (target()[len(square(0.1)) :], "nothing to solve"),
        (target(translation=(0, 0, 0), potential="electrode"), "touch or cross"),
    ],
)
def test_what_cannot_be_solved_is_refused_with_its_name(text: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as refused:
        conductors(loads(text), "scene.toml")
    assert str(refused.value).startswith("scene.toml: ")
