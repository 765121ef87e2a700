"""Scene files: what is read, the canonical text that is written and whose hash is the identity, and how a refusal names file, line, key and reason; each key is spoiled in turn by tests/bad_input."""

import re
from pathlib import Path

import pytest
import tomli_w

from geometries.common.errors import InputError
from geometries.scene import reader, rectangles
from geometries.scene.poses import AxisRotation, Mimic, Pose, QuaternionRotation
from geometries.scene.scene import DistanceSensor, Link, Medium, Object, Plate, Reading, Room, Scene, Sensor
from geometries.scene.shapes import PlateShape, Sphere
from geometries.scene.writer import canonical, identity
from geometries.studies import families
from tests import scenes
from tests.geometries.schemas import WHOLE

SENSOR = scenes.sensor("s", [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]])


def test_everything_that_a_scene_may_hold_is_read() -> None:
    scene = reader.loads(tomli_w.dumps(WHOLE))
    assert scene.medium == Medium(2.0)
    assert scene.room == Room((4.0, 3.0, 2.5), Pose((0.0, 0.0, 1.25)))
    base, arm, finger = scene.links
    assert base == Link("base", pose=Pose((0.1, 0.2, 0.3), AxisRotation((0.0, 0.0, 1.0), 30.0)))
    assert arm.parent == "base" and arm.joint is not None and finger.joint is not None
    assert (arm.joint.name, arm.joint.axis, arm.joint.lower, arm.joint.upper) == ("elbow", (0, 0, 1), -2, 2)
    assert arm.joint.rest == Pose(rotation=QuaternionRotation((1.0, 0.0, 0.0, 0.5)))
    assert finger.joint.mimic == Mimic("elbow", 0.1, 0.01)
    plate = Plate((0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 0.1, 0.0))
    assert scene.sensors == (Sensor("front", (plate,), "arm", 5.0, 1e-12),)
    assert scene.distance_sensors == (DistanceSensor("eye", (0, 0, 0), (0, 0, 1), 40.0, 0.8, "arm"),)
    objects = {body.name: body for body in scene.objects}
    assert objects["front cover"].relative_permittivity == 3
    assert objects["ball"] == Object(
        "ball",
        Sphere(0.05, 8),
        "base",
        Pose((0.5, 0.0, 0.02)),
        potential="floating",
        to_ground=1e-10,
        target=True,
        collides=False,
        collides_with_parent=True,
    )
    ring = objects["ring"]
    assert ring.pose == Pose(rotation=QuaternionRotation((1.0, 0.0, 0.0, 0.5)))
    assert ring.relative_permittivity == 3 and objects["post"].conductor == "mast"
    assert (objects["guard"].potential, objects["guard"].conductor) == ("electrode", "shield")
    assert scene.readings == (Reading("near", "front", ("front", "shield"), 1e-15, 1e-14),)


def test_what_is_left_out_takes_the_defaults_of_the_format() -> None:
    scene = reader.loads(SENSOR + scenes.body("o", "plane", size=[1, 1]))
    assert scene.medium.relative_permittivity == 1
    assert (scene.sensors[0].input_voltage, scene.sensors[0].coupling_capacitance) == (2.5, 5e-12)
    assert scene.objects == (Object("o", PlateShape((1.0, 1.0))),)


@pytest.mark.parametrize(
    ("text", "key", "reason"),
    [
        ("", "", "at least one sensor or one object"),
        (SENSOR + "[[wall]]\n", "wall", "unknown key"),
        (
            SENSOR + scenes.link("a", parent="b") + scenes.link("b", parent="a"),
            'link "a": parent',
            "cycle: a → b → a",
        ),
        (
            scenes.body("o", "torus"),
            'object "o": shape.type',
            "must be one of plate, plane, cuboid, box, cube",
        ),
    ],
)
def test_what_the_format_does_not_allow_is_refused_by_key_and_reason(
    text: str, key: str, reason: str
) -> None:
    with pytest.raises(InputError) as caught:
        reader.loads(text, source="scene.toml")
    assert (caught.value.file, caught.value.key) == ("scene.toml", key)
    assert reason in caught.value.reason


def test_text_that_is_not_toml_is_refused_with_its_line() -> None:
    with pytest.raises(InputError, match=r"^scene\.toml:2: is not TOML: "):
        reader.loads("[medium]\nrelative_permittivity = = 2\n", source="scene.toml")


def test_an_error_reads_file_key_reason(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(SENSOR + "voltage = 3")
    with pytest.raises(InputError) as caught:
        reader.load(path)
    assert str(caught.value) == (
        f'{path}: sensor "s": voltage: unknown key; '
        "there are coupling_capacitance, cover, input_voltage, link, name, plates"
    )


# Has every kind of length; shapes in millimetres are tried by tests/end_to_end/test_scene_readers_agree.py. L stands behind a number of millimetres, P behind one per millimetre.
LENGTHS = """
[room]
size = [4000L, 3000L, 2500L]
translation = [0, 0, 1250L]
[[link]]
name = "arm"
translation = [0, 0, 500L]
joint = { name = "slide", type = "prismatic", axis = [0, 0, 1], position = 20L, lower = -30L, upper = 40L }
[[link]]
name = "wheel"
joint = { name = "turn", type = "revolute", axis = [0, 0, 1], mimic = { joint = "slide", multiplier = 0.5P, offset = 0.25 } }
[[link]]
name = "rack"
joint = { name = "push", type = "prismatic", axis = [0, 0, 1], mimic = { joint = "turn", multiplier = 8L, offset = 3L } }
[[sensor]]
name = "front"
plates = [ { corner = [-50L, 1L, 2L], edge_u = [100L, 0, 0], edge_v = [0, 30L, 0] } ]
[[distance_sensor]]
name = "eye"
apex = [1L, 2L, 3L]
direction = [0, 0, 2]
full_angle_degrees = 40
range = 800L
[[object]]
name = "ball"
shape = { type = "sphere", radius = 50L }
translation = [0, 0, 20L]
"""
IN_MILLIMETRES = 'units = "mm"\n' + re.sub("[LP]", "", LENGTHS)
IN_METRES = re.sub(
    r"(-?[0-9.]+)([LP])", lambda m: repr(float(m[1]) / 1000 if m[2] == "L" else float(m[1]) * 1000), LENGTHS
)


def test_lengths_may_be_in_millimetres_and_are_written_in_metres() -> None:
    assert reader.loads(IN_MILLIMETRES) == reader.loads(IN_METRES)
    assert canonical(reader.loads(IN_MILLIMETRES)) == canonical(reader.loads(IN_METRES))
    assert reader.loads('units = "m"\n' + IN_METRES) == reader.loads(IN_METRES)


def test_a_plate_that_is_nearly_a_rectangle_is_squared_and_one_that_is_not_is_refused() -> None:
    def read(edge_v: list[float]) -> Scene:
        return reader.loads(scenes.sensor("s", [[0, 0, 0], [0.1, 0, 0], edge_v]))

    scene = read([9e-6, 0.1, 0])
    assert scene.changes == (
        'sensor "s": plates[0]: edge_u and edge_v are 0.0052 degrees off the right angle and are squared',
    )
    assert abs(rectangles.cosine_between_edges(scene.sensors[0].plates[0])) < 1e-15
    again = reader.loads(canonical(scene))
    assert again == scene and again.changes == ()
    assert read([9e-11, 0.1, 0]).sensors[0].plates[0].edge_v == (9e-11, 0.1, 0.0)
    with pytest.raises(InputError, match="89.9885 degrees, its cosine 0.0002, and at most 0.0001 is squared"):
        read([2e-5, 0.1, 0])


@pytest.mark.parametrize(
    "scene",
    [
        reader.loads(tomli_w.dumps(WHOLE)),
        families.parallel((0.1, 0.1), (0.2, 0.2), 0.0137),
        families.corner((0.073, 0.119), (0.1, 0.1), (0.01, 0.02), 0.003, 17.2, 33.0),
    ],
    ids=["full", "parallel", "corner"],
)
def test_the_canonical_text_loads_to_an_equal_scene_and_is_its_own_canonical_text(scene: Scene) -> None:
    text = canonical(scene)
    again = reader.loads(text)
    assert again == scene
    assert canonical(again) == text


def test_order_of_keys_integers_defaults_and_the_sign_of_zero_do_not_change_the_identity() -> None:
    plain = scenes.sensor("s", [[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    wordy = """
        [medium]
        relative_permittivity = 1.0
        [[sensor]]
        plates = [{ edge_v = [0.0, 1.0, -0.0], corner = [0.0, -0.0, 0.0], edge_u = [1e0, 0, 0] }]
        coupling_capacitance = 5e-12
        input_voltage = 2.5
        name = "s"
    """
    assert identity(reader.loads(plain)) == identity(reader.loads(wordy))


def test_the_last_bit_of_a_number_changes_the_identity() -> None:
    ids = {identity(families.parallel((0.1, 0.1), (0.1, 0.1), gap)) for gap in (0.3, 0.1 + 0.2)}
    assert len(ids) == 2
