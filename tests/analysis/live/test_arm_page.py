"""An imported arm, whose links are turned in their parents, on a live page: links, answers and joints stand where they do natively."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis import live
from analysis.pipeline.model_stage import model_module
from geometries.scene import motion, poses, reader
from geometries.scene.scene import Scene
from tests import scenes
from tests.analysis.live.browser import Browser, opened, skip_where_missing
from tests.end_to_end.importing import imported

skip_where_missing()

ROBOT = """<robot name="arm">
  <link name="base"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <link name="upper"><collision><origin xyz="0 -0.15 0"/><geometry><box size="0.05 0.2 0.05"/></geometry></collision></link>
  <link name="lower"><collision><origin xyz="0.1 0 0"/><geometry><box size="0.15 0.05 0.05"/></geometry></collision></link>
  <link name="tool"><collision><geometry><box size="0.04 0.04 0.04"/></geometry></collision></link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><origin xyz="0 0 0.1" rpy="-1.5707963267948966 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper"/><child link="lower"/><origin xyz="0 -0.3 0" rpy="1.5707963267948966 0.4 0"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="wrist" type="prismatic">
    <parent link="lower"/><child link="tool"/><origin xyz="0.22 0 0" rpy="0.3 -1.5707963267948966 0"/><axis xyz="0 0 -1"/>
    <limit lower="0" upper="0.1" effort="1" velocity="1"/>
    <mimic joint="elbow" multiplier="0.05" offset="0.01"/>
  </joint>
</robot>
"""
SENSOR_AND_HAND = (
    scenes.sensor("tip", [[-0.03, -0.03, 0.03], [0.06, 0, 0], [0, 0.06, 0]], link="tool")
    + scenes.eye("eye", [0, 0, 0.03], [0, 0, 1], 60, 2, link="tool")
    + scenes.link("wheel", rotation={"axis": [0, 0, 1], "degrees": 90})
    + scenes.body("hand", "sphere", radius=0.05, link="wheel", translation=[0.1, -0.5, 0.3], target=True)
)
JOINTS = ({"shoulder": 0.0, "elbow": 0.0}, {"shoulder": 0.7, "elbow": 0.9}, {"shoulder": -1.1, "elbow": 0.3})
"""Positions of the joints in the frames, in rad."""
MOTION = scenes.table("frame", name="rest") + "".join(
    scenes.table("frame", joints=[{"joint": joint, "position": at} for joint, at in positions.items()])
    for positions in JOINTS[1:]
)
ROUNDING = 1e-9
SAID = """
    const {scene} = window.livePage;
    return {poses: scene.poses(), exact: scene.capacitance("exact"), eyes: scene.distances().distance_sensors, pairs: scene.collisions().pairs};"""


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("arm")
    (folder / "arm.urdf").write_text(ROBOT)
    imported(folder / "arm.urdf")
    path = folder / "scene.toml"
    path.write_text(path.read_text() + SENSOR_AND_HAND)
    (folder / "moved.toml").write_text(MOTION)
    return path


@pytest.fixture(scope="module")
def page(arm: Path) -> Iterator[Browser]:
    target = live.make(str(arm), arm.with_name("moved.toml"), arm.with_name("page.html"), None)
    with Browser() as browser:
        opened(browser, target)
        yield browser


def assert_stands_as_natively(said: dict[str, Any], arm: Path, frame: motion.Frame) -> None:
    scene = reader.load(arm)
    moved: Scene = replace(
        scene, links=tuple(replace(link, pose=frame.poses[link.name]) for link in scene.links)
    )
    for link, pose in zip(moved.links, said["poses"], strict=True):
        truth = moved.transform_of_link(link.name)
        expected = np.column_stack([truth.rotation, truth.translation])
        np.testing.assert_allclose(np.reshape(pose, (3, 4)), expected, atol=1e-12, err_msg=link.name)
    native = model_module().Scene.load(str(arm))
    for name, pose in frame.poses.items():
        native.set_pose(name, np.array(pose.translation), poses.quaternion(pose.rotation))
    [sensor], [other] = said["exact"]["sensors"], native.capacitance()["sensors"]
    for body, expected in zip(sensor["objects"], other["objects"], strict=True):
        np.testing.assert_allclose(body["capacitance"], expected["capacitance"], rtol=ROUNDING)
    [eye], [other] = said["eyes"], native.sense()["distance_sensors"]
    assert eye["object"] == other["object"]
    assert eye["distance"] == pytest.approx(other["distance"], rel=ROUNDING)
    assert said["pairs"] == native.collide()["pairs"]


@pytest.mark.parametrize("number", range(len(JOINTS)))
def test_links_below_turned_links_stand_where_they_do_natively(arm: Path, page: Browser, number: int) -> None:
    frame = motion.load(arm.with_name("moved.toml"), reader.load(arm))[number]
    page.run("window.livePage.choosePath(0); window.livePage.goTo(arguments[0])", number)
    assert_stands_as_natively(page.run(SAID), arm, frame)
    page.run("document.getElementById('home').click()")
    for joint, position in JOINTS[number].items():
        page.run("window.livePage.scene.setJoint(arguments[0], arguments[1])", joint, position)
    assert_stands_as_natively(page.run(SAID), arm, frame)
    assert page.complaints() == []
