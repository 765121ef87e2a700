"""Rotations and poses. A pose maps p to R·p + t: rotate, then translate."""

from __future__ import annotations

import math
from dataclasses import dataclass

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
