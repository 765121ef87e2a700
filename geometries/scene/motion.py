"""Reads motion files: frames, each with the poses of a scene's links or the positions of its joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from geometries.common.errors import InputError
from geometries.common.tables import Table, parse, read_text
from geometries.scene import reader
from geometries.scene.poses import PRISMATIC, Joint, Pose, QuaternionRotation, quaternion, resolved
from geometries.scene.scene import Scene


@dataclass(frozen=True)
class Frame:
    """The pose of every link relative to its parent, in the scene's order."""

    name: str
    poses: dict[str, Pose]


def load(path: Path | str, scene: Scene) -> tuple[Frame, ...]:
    """Returns the frames in a file; InputError when the file cannot be used with the scene."""
    return loads(read_text(Path(path)), scene, source=str(path))


def loads(text: str, scene: Scene, source: str = "motion") -> tuple[Frame, ...]:
    """Returns the frames in a text; `source` stands for it in errors."""
    root = parse(text, source)
    root.known_format()
    root.read_units()
    poses = at_rest(scene).poses
    joints = {link.joint.name: link.joint for link in scene.links if link.joint}
    link_of = {link.joint.name: link.name for link in scene.links if link.joint}
    frames = []
    for index, table in enumerate(root.tables("frame")):
        # A frame's name need not be unique, so errors give its index.
        table.label = f"frame[{index}]"
        name = table.text("name", f"frame {index + 1}")
        moved = _moved(table, poses)
        turned = _turned(table, joints)
        joints = joints | turned
        for joint in turned.values():
            if link_of[joint.name] in moved:
                raise table.error("joints", f"{link_of[joint.name]!r} has a pose in this frame already")
            moved[link_of[joint.name]] = joint.pose_at(joint.position)
        poses = poses | moved
        table.finish()
        frames.append(Frame(name, poses))
    root.finish()
    if not frames:
        raise InputError(source, "frame", "a motion needs at least one frame")
    return tuple(frames)


def at_rest(scene: Scene) -> Frame:
    """Returns the frame with the poses of the scene's file."""
    return Frame("as in the scene", {link.name: link.pose for link in scene.links})


def with_frames_between(frames: Sequence[Frame], count: int) -> tuple[Frame, ...]:
    """Returns the frames of a motion with `count` more between every two of them, in which links move evenly along straight lines and
    turn evenly by the shorter way."""
    filled: list[Frame] = []
    for before, after in zip(frames, frames[1:]):
        filled.append(before)
        for k in range(1, count + 1):
            share = k / (count + 1)
            name = f"{before.name} to {after.name}, {100 * share:.0f} %"
            filled.append(
                Frame(
                    name,
                    {link: _between(pose, after.poses[link], share) for link, pose in before.poses.items()},
                )
            )
    return (*filled, *frames[-1:])


def _between(before: Pose, after: Pose, share: float) -> Pose:
    x, y, z = ((1 - share) * np.array(before.translation) + share * np.array(after.translation)).tolist()
    a, b = quaternion(before.rotation), quaternion(after.rotation)
    if a @ b < 0:
        b = -b
    half = np.arctan2(np.linalg.norm(b - (a @ b) * a), a @ b)
    if half < 1e-9:
        return Pose((x, y, z), before.rotation)
    w, i, j, k = ((np.sin((1 - share) * half) * a + np.sin(share * half) * b) / np.sin(half)).tolist()
    return Pose((x, y, z), QuaternionRotation((w, i, j, k)))


def _moved(frame: Table, before: dict[str, Pose]) -> dict[str, Pose]:
    moved: dict[str, Pose] = {}
    for table in frame.tables("poses"):
        link = table.text("link")
        if link not in before:
            raise table.error("link", f"there is no link {link!r}")
        if link in moved:
            raise table.error("link", f"{link!r} has a pose in this frame already")
        turns = table.has("rotation") or table.has("quaternion")
        moved[link] = Pose(
            table.position("translation", before[link].translation),
            reader.rotation(table) if turns else before[link].rotation,
        )
        table.finish()
    return moved


def _turned(frame: Table, joints: dict[str, Joint]) -> dict[str, Joint]:
    """Returns the joints that a frame moves, with those that follow them."""
    asked: dict[str, Joint] = {}
    for table in frame.tables("joints"):
        name = table.text("joint")
        if name not in joints:
            choices = ", ".join(joint.name for joint in joints.values() if joint.mimic is None)
            raise table.error("joint", f"there is no joint {name!r}; there are: {choices or 'none'}")
        mimic = joints[name].mimic
        if mimic is not None:
            raise table.error("joint", f"{name!r} follows {mimic.joint!r} and cannot be set")
        if name in asked:
            raise table.error("joint", f"{name!r} has a position in this frame already")
        is_length = joints[name].kind == PRISMATIC
        position = table.length("position") if is_length else table.number("position")
        asked[name] = replace(joints[name], position=position)
        table.finish()
    try:
        placed = resolved(joints | asked)
    except ValueError as error:
        raise frame.error("joints", str(error)) from error
    return {name: placed[name] for name in joints if _leader(joints, name) in asked}


def _leader(joints: dict[str, Joint], name: str) -> str:
    """Returns the joint that a joint follows in the end; itself if none."""
    mimic = joints[name].mimic
    return name if mimic is None else _leader(joints, mimic.joint)
