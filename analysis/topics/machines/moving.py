"""Machines whose links move before a target. `moving_truths.json` has true changes of their readings (F) with errors, by machine, pose and reading.

`python3 -m analysis measure moving FOLDER` writes the machines as scenes with motions, for other programs.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

from analysis.topics.machines import hand_before_arm
from geometries.scene import motion, reader
from geometries.scene.poses import AxisRotation, Pose, Vector3
from geometries.scene.scene import Link, Object, Plate, Scene, Sensor
from geometries.scene.shapes import Capsule, Cuboid, Cylinder, Shape, Sphere
from geometries.scene.writer import canonical

Array = NDArray[np.float64]

FILE = Path(__file__).with_name("moving_truths.json")
POSES, POSES_OF_HAND = 200, 500
"""Poses of a motion."""
HAND = "hand"
"""The machine of which only the target moves."""
_SCENES = Path(__file__).parents[3] / "geometries" / "scenes"
_PATIENT = ("head", "neck", "torso", "left arm", "right arm", "left leg", "right leg")
_SEGMENTS = 24


@dataclass(frozen=True)
class Moving:
    """A scene, and the poses of its links relative to their parents, (poses, links, 4, 4)."""

    name: str
    scene: Scene
    poses: Array


def x_ray_arm() -> Moving:
    """Returns the X-ray arm with the patient as target, in steps of equal number between the frames of its motion."""
    scene = reader.load(_SCENES / "x_ray_arm.toml")
    frames = motion.load(_SCENES / "x_ray_arm.motion.toml", scene)
    objects = tuple(replace(each, target=each.name in _PATIENT) for each in scene.objects)
    poses = np.tile(np.eye(4), (POSES, len(scene.links), 1, 1))
    times = np.linspace(0, len(frames) - 1, POSES)
    for number, link in enumerate(scene.links):
        own = [frame.poses[link.name].transform() for frame in frames]
        turns = Slerp(np.arange(len(frames)), Rotation.from_matrix([each.rotation for each in own]))
        poses[:, number, :3, :3] = turns(times).as_matrix()
        places = np.array([each.translation for each in own])
        for axis in range(3):
            poses[:, number, axis, 3] = np.interp(times, np.arange(len(frames)), places[:, axis])
    return Moving("X-ray arm", replace(scene, objects=objects), poses)


_Vector = tuple[float, float, float]


@dataclass(frozen=True)
class _Joint:
    """A revolute joint: where its link begins on the link before, its axis, and its angle in the motion: the mean, the amplitude (rad) and its periods."""

    begin: _Vector
    axis: _Vector
    mean: float
    amplitude: float
    periods: float


_JOINTS = (
    _Joint((0, 0, 0.1), (0, 0, 1), 0.0, 0.5, 1.0),
    _Joint((0, 0, 0.1), (0, 1, 0), 0.5, 0.25, 1.5),
    _Joint((0, 0, 0.42), (0, 1, 0), 0.9, 0.35, 2.0),
    _Joint((0, 0, 0.4), (0, 1, 0), 0.3, 0.4, 2.5),
    _Joint((0, 0, 0.11), (1, 0, 0), 0.0, 0.4, 3.0),
    _Joint((0, 0, 0.11), (0, 0, 1), 0.0, 0.8, 2.0),
)


def six_joint_arm() -> Moving:
    """Returns an arm of six joints, each of which moves, with sensors on its upper arm, forearm and tool, before a person's trunk, arm and hand."""
    links = [Link("base")]
    for number, joint in enumerate(_JOINTS):
        links.append(Link(f"link {number + 1}", links[-1].name, Pose(joint.begin)))

    def body(
        name: str,
        link: int | None,
        shape: Shape,
        at: Vector3,
        turn: AxisRotation | None = None,
        target: bool = False,
    ) -> Object:
        return Object(
            name,
            shape,
            None if link is None else links[link].name,
            Pose(at, turn or AxisRotation()),
            target=target,
        )

    across = AxisRotation((1.0, 0.0, 0.0), 90.0)
    objects = (
        body("foot", 0, Cylinder(0.1, 0.1, _SEGMENTS), (0.0, 0.0, 0.05)),
        body("shoulder", 1, Cylinder(0.075, 0.18, _SEGMENTS), (0.0, 0.0, 0.07)),
        body("upper arm", 2, Capsule(0.055, 0.4, _SEGMENTS), (0.0, 0.0, 0.21)),
        body("elbow", 3, Cylinder(0.06, 0.14, _SEGMENTS), (0.0, 0.0, 0.0), across),
        body("forearm", 3, Cuboid((0.09, 0.09, 0.37)), (0.0, 0.0, 0.2)),
        body("wrist 1", 4, Capsule(0.042, 0.09, _SEGMENTS), (0.0, 0.0, 0.055)),
        body("wrist 2", 5, Capsule(0.04, 0.09, _SEGMENTS), (0.0, 0.0, 0.055)),
        body("tool flange", 6, Cylinder(0.05, 0.08, _SEGMENTS), (0.0, 0.0, 0.05)),
        body("trunk", None, Capsule(0.14, 0.5, _SEGMENTS), (1.06, 0.0, 0.45), target=True),
        body("hand", None, Sphere(0.05, _SEGMENTS), (0.7, 0.22, 0.4), target=True),
        body(
            "arm",
            None,
            Capsule(0.035, 0.26, _SEGMENTS),
            (0.84, 0.19, 0.43),
            AxisRotation((0.0, 1.0, 0.0), 80.0),
            target=True,
        ),
    )

    def sensor(name: str, link: int, corner: _Vector, u: _Vector, v: _Vector) -> Sensor:
        return Sensor(name, (Plate(corner, u, v),), links[link].name)

    sensors = (
        sensor("upper arm front", 2, (0.067, -0.03, 0.1), (0, 0.06, 0), (0, 0, 0.22)),
        sensor("upper arm left", 2, (-0.03, 0.067, 0.1), (0.06, 0, 0), (0, 0, 0.22)),
        sensor("forearm front", 3, (0.057, -0.04, 0.1), (0, 0.08, 0), (0, 0, 0.24)),
        sensor("forearm back", 3, (-0.057, -0.04, 0.1), (0, 0.08, 0), (0, 0, 0.24)),
        sensor("forearm left", 3, (-0.04, 0.057, 0.1), (0.08, 0, 0), (0, 0, 0.24)),
        sensor("forearm right", 3, (-0.04, -0.057, 0.1), (0.08, 0, 0), (0, 0, 0.24)),
        sensor("tool", 6, (-0.03, -0.03, 0.102), (0.06, 0, 0), (0, 0.06, 0)),
    )
    poses = np.tile(np.eye(4), (POSES, len(links), 1, 1))
    times = np.linspace(0, 1, POSES)
    for number, joint in enumerate(_JOINTS, 1):
        angles = joint.mean + joint.amplitude * np.sin(2 * math.pi * joint.periods * times + number)
        poses[:, number, :3, :3] = Rotation.from_rotvec(np.outer(angles, joint.axis)).as_matrix()
        poses[:, number, :3, 3] = joint.begin
    return Moving("six-joint arm", Scene(links=tuple(links), sensors=sensors, objects=objects), poses)


def hand() -> Moving:
    """Returns the hand before the arm at rest, from 30 to 2 cm."""
    return Moving(HAND, hand_before_arm.scene(), hand_before_arm.poses(POSES_OF_HAND))


MACHINES: dict[str, Callable[[], Moving]] = {
    HAND: hand,
    "X-ray arm": x_ray_arm,
    "six-joint arm": six_joint_arm,
}


def write(machine: Moving, folder: Path) -> Path:
    """Writes a scene file and its motion for other programs, which find the machine as this module does; returns the former."""
    file = folder / f"{machine.name.replace(' ', '_').replace('-', '_').lower()}.toml"
    folder.mkdir(parents=True, exist_ok=True)
    file.write_text(canonical(machine.scene))
    lines = []
    for pose in machine.poses:
        lines.append("[[frame]]\nposes = [")
        for link, matrix in zip(machine.scene.links, pose, strict=True):
            x, y, z, w = Rotation.from_matrix(matrix[:3, :3]).as_quat().tolist()
            lines.append(
                f'  {{ link = "{link.name}", translation = {matrix[:3, 3].tolist()}, quaternion = {[w, x, y, z]} }},'
            )
        lines.append("]\n")
    file.with_suffix(".motion.toml").write_text("\n".join(lines))
    return file


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds what may be asked for."""
    parser.add_argument(
        "folder", type=Path, metavar="FOLDER", help="where to write the scenes and their motions"
    )


def measure(asked: argparse.Namespace) -> int:
    """Writes all machines."""
    for make in MACHINES.values():
        print(write(make(), asked.folder))
    return 0
