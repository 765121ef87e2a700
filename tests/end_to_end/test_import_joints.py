"""Joints of an imported robot: they have positions, follow each other, and a motion turns them by their names."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from analysis.pipeline import model_stage
from geometries.scene import motion, reader
from tests.end_to_end.importing import about, affine, assert_refused, fringe_import, imported

ROBOT = """<robot name="arm">
  <link name="base"><collision><geometry><box size="0.4 0.3 0.2"/></geometry></collision></link>
  <link name="upper arm"><collision><origin xyz="0 0 0.3"/><geometry><box size="0.1 0.1 0.4"/></geometry></collision></link>
  <link name="hand"><collision><geometry><box size="0.1 0.05 0.1"/></geometry></collision></link>
  <link name="thumb"><collision><geometry><box size="0.01 0.02 0.03"/></geometry></collision></link>
  <link name="nail"><collision><geometry><box size="0.01 0.01 0.01"/></geometry></collision></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper arm"/>
    <origin xyz="0 0 0.1" rpy="0.1 -0.2 0.3"/><axis xyz="0 2 0"/><limit lower="-1" upper="1.5" effort="1" velocity="1"/></joint>
  <joint name="lift" type="prismatic"><parent link="upper arm"/><child link="hand"/>
    <origin xyz="0 0 0.6" rpy="0 0 1"/><axis xyz="1 0 0"/><limit lower="0" upper="0.2" effort="1" velocity="1"/></joint>
  <joint name="grip" type="continuous"><parent link="hand"/><child link="thumb"/>
    <origin xyz="0.1 0 0"/><axis xyz="0 0 1"/><mimic joint="shoulder" multiplier="-2" offset="0.1"/></joint>
  <joint name="tip" type="revolute"><parent link="thumb"/><child link="nail"/>
    <axis xyz="1 0 0"/><limit effort="1" velocity="1"/><mimic joint="grip" multiplier="0.5"/></joint>
</robot>
"""


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    path = tmp_path / "arm.urdf"
    path.write_text(ROBOT)
    return path


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


def assert_at(scene: reader.Scene, shoulder: float, lift: float) -> None:
    for link, expected in poses(shoulder, lift).items():
        found = scene.transform_of_link(link)
        assert found.rotation == pytest.approx(expected[:3, :3], abs=1e-12), link
        assert found.translation == pytest.approx(expected[:3, 3], abs=1e-12), link


@pytest.mark.parametrize(
    ("given", "shoulder", "lift"), [("", 0, 0), ("shoulder=0.3,lift=0.15", 0.3, 0.15), ("lift=2e-1", 0, 0.2)]
)
def test_joints_are_set_and_those_that_mimic_follow(
    robot: Path, given: str, shoulder: float, lift: float
) -> None:
    assert_at(imported(robot, *(["--joints", given] if given else [])), shoulder, lift)


def test_joints_may_be_given_several_times(robot: Path) -> None:
    assert_at(imported(robot, "--joints", "shoulder=-0.5", "--joints", "lift=0.1"), -0.5, 0.1)


def test_a_motion_turns_joints_by_their_names(robot: Path) -> None:
    scene = imported(robot, "--joints", "lift=0.1")
    frames = motion.loads(
        '[[frame]]\njoints = [ { joint = "shoulder", position = 0.4 } ]\n[[frame]]\njoints = [ { joint = "lift", position = 0.2 } ]\n'
        '[[frame]]\nposes = [ { link = "hand", translation = [0, 0, 1] } ]\njoints = [ { joint = "shoulder", position = 0 } ]\n'
        '[[frame]]\njoints = [ { joint = "lift", position = 0 } ]\n',
        scene,
    )
    expected = [(0.4, 0.1), (0.4, 0.2), (0, None), (0, 0)]
    for frame, (shoulder, lift) in zip(frames, expected, strict=True):
        links = tuple(reader.replace(link, pose=frame.poses[link.name]) for link in scene.links)
        moved = reader.replace(scene, links=links)
        if lift is not None:
            assert_at(moved, shoulder, lift)
        else:
            assert frame.poses["hand"].translation == (0, 0, 1)


def test_the_module_turns_joints_by_their_names(robot: Path) -> None:
    imported(robot, "--joints", "lift=0.1")
    path = robot.with_name("scene.toml")
    live = model_stage.model_module().Scene.load(str(path))
    live.set_joint("shoulder", 0.4)
    expected = imported(robot, "--joints", "shoulder=0.4,lift=0.1").conductors()
    for name, triangles in live.conductors().items():
        assert triangles == pytest.approx(expected[name], abs=1e-12)
    with pytest.raises(ValueError, match='there is no joint "elbow"; there are: shoulder, lift'):
        live.set_joint("elbow", 0)
    with pytest.raises(ValueError, match='joint "tip" follows "grip"'):
        live.set_joint("tip", 0)
    with pytest.raises(ValueError, match="finite"):
        live.set_joint("shoulder", math.nan)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("elbow=1", 'joint "elbow": does not exist or does not move; there are: shoulder, lift'),
        ("tip=1", 'joint "tip": follows "grip"'),
    ],
)
def test_joints_that_cannot_be_set_are_refused(robot: Path, given: str, told: str) -> None:
    assert_refused(robot, told, "--joints", given)


@pytest.mark.parametrize(
    "given",
    ["shoulder", "shoulder=", "shoulder=far", "=1", "shoulder=nan", "shoulder=1,shoulder=2", "shoulder=1,"],
)
def test_positions_that_are_none_are_refused(robot: Path, given: str) -> None:
    done = fringe_import(robot, robot.with_name("scene.toml"), "--joints", given)
    assert done.returncode == 2 and "--joints: " in done.stderr and not robot.with_name("scene.toml").exists()


def test_a_position_beyond_the_limits_is_told(robot: Path) -> None:
    scene = imported(
        robot,
        "--joints",
        "shoulder=2",
        warnings='joint "shoulder": the position 2 is beyond its limits, -1 to 1.5',
    )
    assert_at(scene, 2, 0)


def test_limits_are_in_the_scene(robot: Path) -> None:
    joints = {link.joint.name: link.joint for link in imported(robot).links if link.joint}
    assert list(joints) == ["shoulder", "lift", "grip", "tip"]
    assert (joints["shoulder"].lower, joints["shoulder"].upper) == (-1, 1.5)
    assert (joints["grip"].lower, joints["tip"].upper) == (None, None)


def test_a_joint_that_mimics_nothing_is_told_and_can_be_set(robot: Path) -> None:
    robot.write_text(ROBOT.replace('mimic joint="shoulder"', 'mimic joint="hip"'))
    told = 'joint "grip": mimics "hip", which does not exist; it stays at its offset'
    scene = imported(robot, warnings=told)
    assert scene.transform_of_link("thumb").rotation == pytest.approx(
        poses(0, 0)["hand"][:3, :3] @ about(2, 0.1), abs=1e-12
    )
    imported(robot, "--joints", "grip=0.5", warnings=told)


def test_a_joint_that_mimics_a_fixed_one_is_at_its_offset(robot: Path) -> None:
    robot.write_text(ROBOT.replace('name="shoulder" type="revolute"', 'name="shoulder" type="fixed"'))
    assert_at(imported(robot), 0, 0)


def test_a_robot_needs_no_name_and_no_materials(robot: Path) -> None:
    material = '<visual><geometry><box size="1 1 1"/></geometry><material name="unknown"/></visual>'
    robot.write_text(
        ROBOT.replace(' name="arm"', "").replace('<link name="nail">', f'<link name="nail">{material}')
    )
    assert_at(imported(robot, warnings="robot: has no name"), 0, 0)


OBJ = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 2 3\nf 1 3 4\n"


@pytest.mark.parametrize(
    ("name", "file", "told"),
    [
        ("package:///robots/meshes/part.obj", "robots/meshes/part.obj", ""),
        ("package://robots/meshes/part.obj", "robots/meshes/part.obj", ""),
        ("package://arm_description/meshes/part.obj", "robots/meshes/part.obj", "is taken from"),
        ("package://arm_description/meshes/part.obj", "elsewhere/part.obj", None),
    ],
)
def test_packages_are_found_beside_the_robot(tmp_path: Path, name: str, file: str, told: str | None) -> None:
    path = tmp_path / "robots" / "urdf" / "arm.urdf"
    path.parent.mkdir(parents=True)
    (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / file).write_text(OBJ)
    path.write_text(
        f'<robot name="r"><link name="a"><collision><geometry><mesh filename="{name}"/></geometry></collision></link></robot>'
    )
    if told is None and "elsewhere" in file:
        assert_refused(path, f'link "a": mesh: {name} was not found')
    else:
        assert len(imported(path, warnings=told or "").objects) == 1
