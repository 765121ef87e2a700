"""Joints: what turns or shifts links against their parents."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import cast

import numpy as np

from geometries.scene.poses import AxisRotation, Pose, Vector3, product, unit


# The kind of a joint whose position is a length.
PRISMATIC = "prismatic"


@dataclass(frozen=True)
class Mimic:
    """The position follows that of another joint: multiplier·position + offset."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class Joint:
    """A joint of a link: `kind` is revolute or prismatic, positions and limits are in rad or m."""

    name: str
    kind: str
    axis: Vector3
    rest: Pose = Pose()
    """The link's pose at position 0."""
    position: float = 0.0
    lower: float | None = None
    upper: float | None = None
    mimic: Mimic | None = None

    def pose_at(self, position: float) -> Pose:
        """Returns the pose of the joint's link relative to its parent."""
        if position == 0:
            return self.rest
        if self.kind == PRISMATIC:
            shift = self.rest.rotation.matrix() @ (position * unit(self.axis))
            moved = np.asarray(self.rest.translation) + shift
            return Pose(cast(Vector3, tuple(moved.tolist())), self.rest.rotation)
        turn = AxisRotation(self.axis, math.degrees(position))
        return Pose(self.rest.translation, product(self.rest.rotation, turn))


def resolved(joints: Mapping[str, Joint]) -> dict[str, Joint]:
    """Returns the joints by their names with the positions of those that follow others. ValueError with the reason if one
    follows a joint that does not exist, or itself."""
    return {name: replace(joint, position=_position(joint, joints)) for name, joint in joints.items()}


def _position(joint: Joint, joints: Mapping[str, Joint]) -> float:
    multiplier, offset = 1.0, 0.0
    leader = joint
    for _ in range(len(joints) + 1):
        if leader.mimic is None:
            position = offset + multiplier * leader.position
            if not math.isfinite(position):
                raise ValueError(f'joint "{joint.name}": its position must be finite')
            return position
        offset += multiplier * leader.mimic.offset
        multiplier *= leader.mimic.multiplier
        if leader.mimic.joint not in joints:
            raise ValueError(f'joint "{joint.name}": mimics "{leader.mimic.joint}", which does not exist')
        leader = joints[leader.mimic.joint]
    raise ValueError(f'joint "{joint.name}": mimics itself')
