"""From scenes to bodies: poses, scale, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from fem_reference.scene_bodies import conductors
from geometries.errors import InputError
from geometries.reader import loads

SENSOR = """
[[sensor]]
name = "sensor"
plates = [ { corner = [-0.05, -0.05, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] } ]
"""


def target(
    shape: str = '{ type = "plate", size = [0.1, 0.1] }', rest: str = "translation = [0, 0, 0.02]"
) -> str:
    return f'{SENSOR}\n[[object]]\nname = "target"\nshape = {shape}\n{rest}\n'


def test_sensors_come_first_and_bodies_know_their_conductor() -> None:
    found = conductors(loads(target()))
    assert found.names == ("sensor", "target") and found.sensors == 1 and found.owner == (0, 1)


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


@pytest.mark.parametrize(
    "text, words",
    [
        (target(rest="translation = [0, 0, 0]"), '"sensor" and "target": the conductors touch or cross'),
        (target(rest="rotation = { axis = [1, 0, 0], degrees = 90 }"), "touch or cross"),
        (target(rest="translation = [0.1, 0, 0]"), "touch or cross"),
        (target('{ type = "cube", size = 1 }', ""), "touch or cross"),
        (target(rest="translation = [0, 0, 1e-5]"), "too narrow to mesh"),
        (target('{ type = "sphere", radius = 0.01 }'), 'object "target": shape.type'),
        (target(rest='translation = [0, 0, 0.02]\npotential = "floating"'), 'object "target": potential'),
        (target(rest="translation = [0, 0, 0.02]\nmaterial = { relative_permittivity = 50 }"), "material"),
        (target()[len(SENSOR) :], "nothing to solve"),
    ],
)
def test_what_cannot_be_solved_is_refused_with_its_name(text: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as refused:
        conductors(loads(text), "scene.toml")
    assert str(refused.value).startswith("scene.toml: ")
