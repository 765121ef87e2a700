"""Motion files: where each frame puts the links, and how a wrong file is refused."""

from pathlib import Path

import numpy as np
import pytest

from geometries.common.errors import InputError
from geometries.scene import motion, reader
from geometries.scene.poses import AxisRotation, Pose, QuaternionRotation

SCENE = reader.loads(
    """
    [[link]]
    name = "base"
    [[link]]
    name = "arm"
    parent = "base"
    translation = [0, 0, 1]
    rotation = { axis = [0, 0, 1], degrees = 30 }
    [[object]]
    name = "ball"
    link = "arm"
    shape = { type = "sphere", radius = 0.1 }
    """
)
REST = Pose((0.0, 0.0, 1.0), AxisRotation((0.0, 0.0, 1.0), 30.0))


def test_a_frame_moves_the_links_it_names_and_what_it_leaves_out_stays() -> None:
    frames = motion.loads(
        """
        [[frame]]
        name = "rest"
        [[frame]]
        name = "up"
        poses = [ { link = "arm", translation = [0, 0, 2] } ]
        [[frame]]
        poses = [ { link = "arm", rotation = { axis = [1, 0, 0], degrees = 5 } },
                  { link = "base", quaternion = [0, 1, 0, 0] } ]
        """,
        SCENE,
    )
    assert [frame.name for frame in frames] == ["rest", "up", "frame 3"]
    assert [frame.poses["arm"] for frame in frames] == [
        REST,
        Pose((0.0, 0.0, 2.0), REST.rotation),
        Pose((0.0, 0.0, 2.0), AxisRotation((1.0, 0.0, 0.0), 5.0)),
    ]
    assert [frame.poses["base"] for frame in frames] == [
        Pose(),
        Pose(),
        Pose(rotation=QuaternionRotation((0.0, 1.0, 0.0, 0.0))),
    ]


JOINTED = reader.loads(
    """
    [[link]]
    name = "arm"
    translation = [0, 0, 1]
    joint = { name = "lift", type = "prismatic", axis = [0, 0, 2], position = 0.25 }
    [[link]]
    name = "hand"
    joint = { name = "wrist", type = "prismatic", axis = [1, 0, 0], mimic = { joint = "lift", multiplier = -2, offset = 1 } }
    [[link]]
    name = "finger"
    joint = { name = "knuckle", type = "prismatic", axis = [0, 1, 0] }
    [[object]]
    name = "ball"
    shape = { type = "sphere", radius = 0.1 }
    """
)


def test_a_frame_moves_joints_by_their_names_and_those_that_follow() -> None:
    frames = motion.loads(
        """
        [[frame]]
        [[frame]]
        joints = [ { joint = "lift", position = 0.5 } ]
        [[frame]]
        joints = [ { joint = "knuckle", position = 2 } ]
        [[frame]]
        poses = [ { link = "arm", translation = [7, 7, 7] } ]
        [[frame]]
        joints = [ { joint = "lift", position = 0 } ]
        """,
        JOINTED,
    )
    places = [[frame.poses[link].translation for link in ("arm", "hand", "finger")] for frame in frames]
    assert places == [
        [(0, 0, 1.25), (0.5, 0, 0), (0, 0, 0)],
        [(0, 0, 1.5), (0, 0, 0), (0, 0, 0)],
        [(0, 0, 1.5), (0, 0, 0), (0, 2, 0)],
        [(7, 7, 7), (0, 0, 0), (0, 2, 0)],
        [(0, 0, 1), (1, 0, 0), (0, 2, 0)],
    ]


def test_lengths_are_in_the_motions_own_units() -> None:
    text = """
        [[frame]]
        poses = [ { link = "finger", translation = [0, 0, 400] } ]
        joints = [ { joint = "lift", position = 20 } ]
        """
    (in_metres,) = motion.loads(text, JOINTED)
    (in_millimetres,) = motion.loads('units = "mm"' + text, JOINTED)
    assert in_metres.poses["finger"].translation == (0, 0, 400)
    assert in_millimetres.poses["finger"].translation == (0, 0, 0.4)
    lifted = [
        np.subtract(frame.poses["arm"].translation, JOINTED.links[0].joint.rest.translation)
        for frame in (in_metres, in_millimetres)
    ]
    assert np.linalg.norm(lifted[0]) == pytest.approx(20)
    assert np.linalg.norm(lifted[1]) == pytest.approx(0.02)
    with pytest.raises(InputError, match='units: must be "m" or "mm"'):
        motion.loads('units = "inch"' + text, JOINTED)


def test_at_rest_is_the_scene() -> None:
    assert motion.at_rest(SCENE).poses == {"base": Pose(), "arm": REST}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "motion: frame: a motion needs at least one frame"),
        ("[[frames]]", "motion: frames: unknown key; there are format, frame, units"),
        ("[[frame]]\nlinks = []", "motion: frame[0].links: unknown key; there are joints, name, poses"),
        ("[[frame]]\nposes = [{}]", "motion: frame[0].poses[0].link: is missing"),
        ('[[frame]]\n[[frame]]\nposes = [{ link = "leg" }]', "motion: frame[1].poses[0].link: there is no link 'leg'"),
        ('[[frame]]\nposes = [{ link = "arm" }, { link = "arm" }]', "motion: frame[0].poses[1].link: 'arm' has a pose in this frame already"),
        (
            '[[frame]]\nposes = [ { link = "arm", pose = 1 } ]',
            "motion: frame[0].poses[0].pose: unknown key; there are link, quaternion, rotation, translation",
        ),
        (
            '[[frame]]\njoints = [ { joint = "hip", position = 1 } ]',
            "motion: frame[0].joints[0].joint: there is no joint 'hip'; there are: lift, knuckle",
        ),
        ('[[frame]]\njoints = [{ joint = "wrist", position = 1 }]', "motion: frame[0].joints[0].joint: 'wrist' follows 'lift' and cannot be set"),
        (
            '[[frame]]\njoints = [ { joint = "lift", position = 1 }, { joint = "lift", position = 2 } ]',
            "motion: frame[0].joints[1].joint: 'lift' has a position in this frame already",
        ),
        (
            '[[frame]]\nposes = [ { link = "hand" } ]\njoints = [ { joint = "lift", position = 1 } ]',
            "motion: frame[0].joints: 'hand' has a pose in this frame already",
        ),
    ],
)  # fmt: skip
def test_a_wrong_file_is_refused_by_key_and_reason(text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        motion.loads(text, JOINTED if "joints = " in text else SCENE)
    assert str(caught.value) == message


def test_a_file_that_is_no_toml_is_refused_by_its_line(tmp_path: Path) -> None:
    path = tmp_path / "motion.toml"
    path.write_text("[[frame]]\nname = up\n")
    with pytest.raises(InputError, match=rf"^{path}:2: is not TOML"):
        motion.load(path, SCENE)
    with pytest.raises(InputError, match="cannot be read"):
        motion.load(tmp_path / "none.toml", SCENE)


@pytest.mark.parametrize("sign", [1, -1], ids=["", "with the opposite quaternion"])
def test_links_move_evenly_and_turn_by_the_shorter_way_between_frames(sign: int) -> None:
    half = np.radians(100) / 2
    turned = QuaternionRotation((float(sign * np.cos(half)), 0.0, 0.0, float(sign * np.sin(half))))
    frames = (
        motion.Frame("a", {"arm": Pose((0.0, 0.0, 1.0), AxisRotation((0.0, 0.0, 1.0), 40.0))}),
        motion.Frame("b", {"arm": Pose((0.3, 0.0, 1.0), turned)}),
    )
    filled = motion.with_frames_between(frames, 2)
    assert [frame.name for frame in filled] == ["a", "a to b, 33 %", "a to b, 67 %", "b"]
    for frame, x, degrees in zip(filled, (0, 0.1, 0.2, 0.3), (40, 60, 80, 100)):
        pose = frame.poses["arm"]
        expected = AxisRotation((0.0, 0.0, 1.0), degrees).matrix()
        np.testing.assert_allclose(pose.translation, (x, 0, 1), atol=1e-15)
        np.testing.assert_allclose(pose.rotation.matrix(), expected, atol=1e-14)
