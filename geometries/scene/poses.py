"""Rotations, poses and joints. A pose maps p to R·p + t: rotate, then translate; a joint turns or shifts a link against its parent."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import cast

import numpy as np

from geometries.common.arrays import Array

Vector3 = tuple[float, float, float]


def unit(vector: tuple[float, ...]) -> Array:
    """Returns the vector of length 1 in the same direction. It is first scaled by a power of 2 to
    about 1, so that tiny and huge vectors neither underflow nor overflow."""
    exponent = math.frexp(max(abs(value) for value in vector))[1]
    scaled = np.array([math.ldexp(value, -exponent) for value in vector])
    return np.asarray(scaled / np.linalg.norm(scaled))


@dataclass(frozen=True)
class AxisRotation:
    """A turn by `degrees` about `axis` (any length but zero), right-handed."""

    axis: Vector3 = (0.0, 0.0, 1.0)
    degrees: float = 0.0

    def matrix(self) -> Array:
        """Returns the rotation matrix (3, 3), by Rodrigues' formula."""
        x, y, z = unit(self.axis)
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        # Whole turns are removed in degrees, where that is exact.
        angle = math.radians(math.remainder(self.degrees, 360.0))
        return np.asarray(np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * (cross @ cross))


@dataclass(frozen=True)
class QuaternionRotation:
    """A turn given as the quaternion w + xi + yj + zk (any length but zero)."""

    quaternion: tuple[float, float, float, float]

    def matrix(self) -> Array:
        """Returns the rotation matrix (3, 3)."""
        w, x, y, z = unit(self.quaternion)
        return np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
            ]
        )


Rotation = AxisRotation | QuaternionRotation


def quaternion(rotation: Rotation) -> Array:
    """Returns a rotation as the quaternion (w, x, y, z) of length 1."""
    if isinstance(rotation, QuaternionRotation):
        return unit(rotation.quaternion)
    half = math.radians(math.remainder(rotation.degrees, 360.0)) / 2
    return np.array([math.cos(half), *(math.sin(half) * unit(rotation.axis))])


def product(first: Rotation, second: Rotation) -> QuaternionRotation:
    """Returns the rotation that turns by `second`, then by `first`."""
    a, b = quaternion(first), quaternion(second)
    w = a[0] * b[0] - a[1:] @ b[1:]
    x, y, z = a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])
    return QuaternionRotation((float(w), float(x), float(y), float(z)))


@dataclass(frozen=True)
class Pose:
    """Where a frame stands in its parent's: translation in metres, rotation as it was written in the file."""

    translation: Vector3 = (0.0, 0.0, 0.0)
    rotation: Rotation = AxisRotation()

    def transform(self) -> Transform:
        return Transform(self.rotation.matrix(), np.asarray(self.translation))


@dataclass(frozen=True, eq=False)
class Transform:
    """p ↦ R·p + t with R = `rotation` (3, 3) and t = `translation` (3,), in metres."""

    rotation: Array
    translation: Array

    @staticmethod
    def identity() -> Transform:
        return Transform(np.eye(3), np.zeros(3))

    def after(self, inner: Transform) -> Transform:
        """Returns the transform that applies `inner` first and this one second."""
        return Transform(self.rotation @ inner.rotation, self.points(inner.translation))

    def points(self, points: Array) -> Array:
        """Maps points (..., 3)."""
        return np.asarray(points @ self.rotation.T + self.translation)

    def directions(self, directions: Array) -> Array:
        """Maps directions (..., 3): rotated, not moved."""
        return np.asarray(directions @ self.rotation.T)


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
