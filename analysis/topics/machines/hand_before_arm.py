"""A hand that moves before an arm at rest: the scene and the motion of model/benchmarks/hand_before_arm.cpp, with the hand's parts as bodies."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from geometries.scene.poses import AxisRotation, Pose, Vector3
from geometries.scene.scene import Link, Object, Plate, Scene, Sensor
from geometries.scene.shapes import Capsule, Cuboid, Cylinder, RoundedCuboid, Shape, Sphere

Array = NDArray[np.float64]

_TOP = -0.001
"""Height of the sensors on top of the forearm, m."""
_FARTHEST, _NEAREST = 0.3, 0.02
"""Gaps between the hand and these sensors at the beginning and at the end of the motion, m."""
_ALONG_X = AxisRotation((0.0, 1.0, 0.0), 90.0)
_UPRIGHT = AxisRotation()


def scene() -> Scene:
    """Returns the arm of eight overlapping parts with eight sensors around its forearm, and the hand of six parts on a link of its own."""
    return Scene(links=(Link("arm"), Link("hand")), sensors=_sensors(), objects=(*_arm(), *_hand()))


def poses(count: int) -> Array:
    """Returns poses (count, 2, 4, 4) of both links: the hand comes nearer, shifts and turns."""
    corners = np.concatenate(
        [each.pose.transform().points(each.shape.triangles().reshape(-1, 3)) for each in _hand()]
    )
    result = np.tile(np.eye(4), (count, 2, 1, 1))
    for number in range(count):
        part = number / (count - 1)
        turn = math.pi * part
        rotation = (
            AxisRotation((0.0, 0.0, 1.0), math.degrees(math.sin(5 * turn))).matrix()
            @ AxisRotation((1.0, 0.0, 0.0), math.degrees(0.25 * math.sin(9 * turn))).matrix()
        )
        gap = _FARTHEST * (_NEAREST / _FARTHEST) ** part
        lowest = (corners @ rotation.T)[:, 2].min()
        result[number, 1, :3, :3] = rotation
        result[number, 1, :3, 3] = (
            0.12 + 0.15 * math.sin(7 * turn),
            0.03 * math.sin(11 * turn),
            _TOP + gap - lowest,
        )
    return result


def _arm() -> tuple[Object, ...]:
    segments = 32

    def part(name: str, shape: Shape, at: Vector3, turn: AxisRotation = _UPRIGHT) -> Object:
        return Object(name, shape, "arm", Pose(at, turn))

    return (
        part("foot", Cylinder(0.09, 0.1, segments), (-0.45, 0.0, -0.75)),
        part("column", Capsule(0.07, 0.5, segments), (-0.45, 0.0, -0.45)),
        part("shoulder", Sphere(0.085, segments), (-0.45, 0.0, -0.12)),
        part("upper arm", Capsule(0.06, 0.35, segments), (-0.25, 0.0, -0.1), _ALONG_X),
        part("elbow", Sphere(0.07, segments), (-0.05, 0.0, -0.09)),
        part("forearm", Cuboid((0.34, 0.1, 0.1)), (0.13, 0.0, -0.055)),
        part("wrist", Capsule(0.045, 0.12, segments), (0.33, 0.0, -0.055), _ALONG_X),
        part("tool", Cylinder(0.04, 0.1, segments), (0.44, 0.0, -0.055), _ALONG_X),
    )


def _sensors() -> tuple[Sensor, ...]:
    def sensor(name: str, corner: Vector3, u: Vector3, v: Vector3) -> Sensor:
        return Sensor(name, (Plate(corner, u, v),), "arm")

    above = [
        sensor(f"top {k}", (-0.03 + 0.115 * k, -0.045, _TOP), (0.1, 0.0, 0.0), (0.0, 0.09, 0.0))
        for k in range(3)
    ]
    beside = [
        sensor(f"{side} {k}", (0.15 * k, y, -0.1), (0.12, 0.0, 0.0), (0.0, 0.0, 0.09))
        for k in range(2)
        for side, y in (("left", 0.054), ("right", -0.054))
    ]
    return (*above, *beside, sensor("below", (0.03, -0.045, -0.109), (0.2, 0.0, 0.0), (0.0, 0.09, 0.0)))


def _hand() -> tuple[Object, ...]:
    segments = 20

    def part(name: str, shape: Shape, at: Vector3, turn: AxisRotation = _UPRIGHT) -> Object:
        return Object(name, shape, "hand", Pose(at, turn), target=True)

    fingers = [
        part(
            f"finger {k + 1}",
            Capsule(0.009, 0.08, segments),
            (-0.033 + 0.022 * k, 0.075, -0.002 * k),
            AxisRotation((1.0, 0.0, 0.0), 90.0),
        )
        for k in range(4)
    ]
    return (
        part("palm", RoundedCuboid((0.09, 0.1, 0.028), 0.012, segments), (0.0, 0.0, 0.0)),
        *fingers,
        part(
            "thumb", Capsule(0.011, 0.06, segments), (0.055, -0.005, 0.0), AxisRotation((0.0, 1.0, 0.0), 60.0)
        ),
    )
