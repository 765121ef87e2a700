"""The canonical text: one text for each scene, which loads to the same scene; its hash is the scene's identity."""

from __future__ import annotations

import pytest

from geometries.scene import reader, writer
from geometries.scene.scene import Scene
from geometries.studies import families

PLATE = "{ corner = [0, 0, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] }"
FULL = f"""
[[object]]
collides = true
shape = {{ segments = 12, type = "cone", height = 0.1, radius = 0.3 }}
rotation = {{ degrees = 17.2, axis = [1, 0, 0] }}
name = "spike"
link = "arm"
[[object]]
name = "glass"
shape = {{ type = "cube", size = 0.1 }}
material = {{ relative_permittivity = 4 }}
[[object]]
name = "ring"
shape = {{ type = "arc", inner_radius = 0.1, outer_radius = 0.2, height = 0.3, degrees = 100 }}
quaternion = [1, 2, 3, 4]
[[object]]
name = "ball"
shape = {{ type = "sphere", radius = 0.1 }}
conductor = "head"
potential = "electrode"
[[object]]
name = "hand"
shape = {{ type = "sphere", radius = 0.1 }}
target = true
to_ground = 1e-10
potential = "floating"
[[reading]]
noise = 1e-15
drive = ["s", "head"]
sense = "head"
name = "r"
[[object]]
name = "can"
shape = {{ type = "cylinder", radius = 0.1, height = 0.1 }}
translation = [-0.0, 0, 1e-3]
[[distance_sensor]]
name = "eye"
apex = [0, 0, 0]
direction = [0, 0, 1]
full_angle_degrees = 40
range = 0.8
[room]
size = [4, 3, 2]
rotation = {{ axis = [0, 0, 1], degrees = 5 }}
[[sensor]]
plates = [{PLATE}, {PLATE}]
name = "s"
[[link]]
name = "arm"
quaternion = [1, 0, 1, 0]
joint = {{ name = "elbow", type = "revolute", axis = [0, 0, 2], position = 0.3, lower = -1, upper = 1 }}
[[link]]
name = "hand"
joint = {{ name = "wrist", type = "prismatic", axis = [1, 0, 0], mimic = {{ joint = "elbow", offset = 0.5 }} }}
"""


def scenes() -> list[Scene]:
    tilted = families.corner((0.073, 0.119), (0.1, 0.1), (0.01, 0.02), 0.003, 17.2, 33.0)
    return [reader.loads(FULL), families.parallel((0.1, 0.1), (0.2, 0.2), 0.0137), tilted]


@pytest.mark.parametrize("scene", scenes(), ids=["full", "parallel", "corner"])
def test_the_canonical_text_loads_to_an_equal_scene_and_is_its_own_canonical_text(scene: Scene) -> None:
    text = writer.canonical(scene)
    again = reader.loads(text)
    assert again == scene
    assert writer.canonical(again) == text


def test_order_of_keys_integers_defaults_and_the_sign_of_zero_do_not_change_the_identity() -> None:
    plain = (
        '[[sensor]]\nname = "s"\nplates = [{ corner = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 1, 0] }]'
    )
    wordy = """
        [medium]
        relative_permittivity = 1.0
        [[sensor]]
        plates = [{ edge_v = [0.0, 1.0, -0.0], corner = [0.0, -0.0, 0.0], edge_u = [1e0, 0, 0] }]
        coupling_capacitance = 5e-12
        input_voltage = 2.5
        name = "s"
    """
    assert writer.identity(reader.loads(plain)) == writer.identity(reader.loads(wordy))


def test_the_last_bit_of_a_number_changes_the_identity() -> None:
    ids = {writer.identity(families.parallel((0.1, 0.1), (0.1, 0.1), gap)) for gap in (0.3, 0.1 + 0.2)}
    assert len(ids) == 2
