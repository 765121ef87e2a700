"""Joints of an imported robot: they have positions, follow each other, and are set by their names."""

from pathlib import Path

import numpy as np
import pytest

from analysis.pipeline import model_stage
from geometries.scene.scene import Scene
from tests.end_to_end.importing import ROBOT, about, affine, assert_refused, imported, robot_in


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    return robot_in(tmp_path)


def poses(shoulder: float, lift: float) -> dict[str, np.ndarray]:
    """Where the links are, by the definition of URDF."""

    def turned(axis: int, angle: float) -> np.ndarray:
        return affine([0, 0, 0], about(axis, angle))

    def shifted(x: float, y: float, z: float) -> np.ndarray:
        return affine([x, y, z], np.eye(3))

    arm = shifted(0, 0, 0.1) @ turned(2, 0.3) @ turned(1, -0.2) @ turned(0, 0.1) @ turned(1, shoulder)
    hand = arm @ shifted(0, 0, 0.6) @ turned(2, 1) @ shifted(lift, 0, 0)
    grip = 0.1 - 2 * shoulder
    thumb = hand @ shifted(0.1, 0, 0) @ turned(2, grip)
    return {"upper arm": arm, "hand": hand, "thumb": thumb, "nail": thumb @ turned(0, 0.5 * grip)}


def assert_at(scene: Scene, shoulder: float, lift: float) -> None:
    for link, expected in poses(shoulder, lift).items():
        found = scene.transform_of_link(link)
        assert found.rotation == pytest.approx(expected[:3, :3], abs=1e-12), link
        assert found.translation == pytest.approx(expected[:3, 3], abs=1e-12), link


def test_joints_and_their_limits_are_in_the_scene(robot: Path) -> None:
    scene = imported(robot)
    assert_at(scene, 0, 0)
    parents = {link.name: link.parent for link in scene.links}
    assert parents == {
        "base": None,
        "upper arm": "base",
        "hand": "upper arm",
        "thumb": "hand",
        "nail": "thumb",
    }
    joints = {link.joint.name: link.joint for link in scene.links if link.joint}
    assert list(joints) == ["shoulder", "lift", "grip", "tip"]
    assert (joints["shoulder"].lower, joints["shoulder"].upper) == (-1, 1.5)
    assert (joints["grip"].lower, joints["tip"].upper) == (None, None)


@pytest.mark.parametrize(
    ("given", "shoulder", "lift"),
    [
        (["shoulder=0.3,lift=0.15"], 0.3, 0.15),
        (["lift=2e-1"], 0, 0.2),
        (["shoulder=-0.5", "lift=0.1"], -0.5, 0.1),
    ],
)
def test_joints_are_set_and_those_that_mimic_follow(
    robot: Path, given: list[str], shoulder: float, lift: float
) -> None:
    assert_at(imported(robot, *(word for each in given for word in ("--joints", each))), shoulder, lift)


def test_the_module_turns_joints_by_their_names(robot: Path) -> None:
    imported(robot, "--joints", "lift=0.1")
    live = model_stage.model_module().Scene.load(str(robot.with_name("scene.toml")))
    live.set_joint("shoulder", 0.4)
    expected = imported(robot, "--joints", "shoulder=0.4,lift=0.1").conductors()
    for name, triangles in live.conductors().items():
        assert triangles == pytest.approx(expected[name], abs=1e-12)
    with pytest.raises(ValueError, match='there is no joint "elbow"; there are: shoulder, lift'):
        live.set_joint("elbow", 0)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("elbow=1", 'joint "elbow": does not exist or does not move; there are: shoulder, lift'),
        ("tip=1", 'joint "tip": follows "grip"'),
    ],
)
def test_joints_that_cannot_be_set_are_refused(robot: Path, given: str, told: str) -> None:
    assert_refused(robot, told, "--joints", given)


def test_a_position_beyond_the_limits_is_told(robot: Path) -> None:
    told = 'joint "shoulder": the position 2 is beyond its limits, -1 to 1.5'
    assert_at(imported(robot, "--joints", "shoulder=2", warnings=told), 2, 0)


def test_a_joint_that_mimics_nothing_is_told_and_can_be_set(tmp_path: Path) -> None:
    robot = robot_in(tmp_path, ROBOT.replace('mimic joint="shoulder"', 'mimic joint="hip"'))
    told = 'joint "grip": mimics "hip", which does not exist; it stays at its offset'
    expected = poses(0, 0)["hand"][:3, :3] @ about(2, 0.1)
    scene = imported(robot, warnings=told)
    assert scene.transform_of_link("thumb").rotation == pytest.approx(expected, abs=1e-12)
    imported(robot, "--joints", "grip=0.5", warnings=told)


def test_a_joint_that_mimics_a_fixed_one_is_at_its_offset(tmp_path: Path) -> None:
    text = ROBOT.replace('name="shoulder" type="revolute"', 'name="shoulder" type="fixed"')
    assert_at(imported(robot_in(tmp_path, text)), 0, 0)
