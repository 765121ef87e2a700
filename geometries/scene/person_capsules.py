"""A person of capsules: one for each segment of the body, three for the trunk; they overlap at the joints and are one conductor."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from geometries.common.arrays import Array
from geometries.scene.person import BUILDS, Person

SEGMENTS = 12
"""Sides of each capsule's triangles."""


@dataclass(frozen=True)
class PlacedCapsule:
    """A segment from one point to another, swept by a ball; lengths in metres, in the person's frame."""

    name: str
    start: tuple[float, float, float]
    end: tuple[float, float, float]
    radius: float


def capsules(person: Person) -> list[PlacedCapsule]:
    """Returns the capsules of a person. Radii are those of the rings of the person's surface, of circles with their areas."""
    build = BUILDS[person.age]
    trunk, head, limb = build.trunk_width, build.head_width, build.limb_width
    found: list[tuple[str, Array, Array, float]] = []

    def add(
        name: str, start: tuple[float, float, float], end: tuple[float, float, float], radius: float
    ) -> None:
        """Adds a capsule between its two ends, the half balls included."""
        a, b = np.array(start), np.array(end)
        along = (b - a) / np.linalg.norm(b - a)
        found.append((name, a + radius * along, b - radius * along, radius))

    depth = 0.064 * trunk
    for name, y in (("trunk left", 0.032 * trunk), ("trunk", 0.0), ("trunk right", -0.032 * trunk)):
        add(name, (0.0, y, build.crotch), (0.0, y, build.shoulder), depth)
    add("neck", (0.0, 0.0, build.shoulder - 0.05), (0.0, 0.0, build.chin + 0.05), 0.032 * head)
    add(
        "head",
        (0.005 * head, 0.0, build.chin),
        (0.005 * head, 0.0, 1.0),
        min(0.0485 * head, 0.499 * (1 - build.chin)),
    )
    elbow, wrist = build.shoulder - build.upper_arm, build.shoulder - build.upper_arm - build.forearm
    height = build.shoulder - 0.18 * build.upper_arm
    for side, sign in (("left", 1.0), ("right", -1.0)):
        hip = sign * 0.047 * limb
        add(f"thigh {side}", (0.0, hip, build.crotch + 0.04), (0.0, hip, build.knee - 0.03), 0.039 * limb)
        add(f"shank {side}", (0.0, hip, build.knee + 0.02), (0.0, hip, 0.0), 0.0275 * limb)
        add(
            f"foot {side}",
            (-0.041 * limb, hip, 0.021 * limb),
            (0.111 * limb, hip, 0.021 * limb),
            0.021 * limb,
        )
        # Inside the trunk's surface the shoulder begins.
        inner, outer = sign * 0.07 * trunk, sign * (0.098 * trunk + 0.045 * limb)
        add(f"shoulder {side}", (0.0, inner, height), (0.0, outer + sign * 0.02 * limb, height), 0.028 * limb)
        if sign < 0 and person.posture == "arm_stretched":
            arm = (
                build.upper_arm,
                build.upper_arm + build.forearm,
                build.upper_arm + build.forearm + build.hand,
            )
            add(f"upper arm {side}", (-0.02, outer, height), (arm[0] + 0.02, outer, height), 0.025 * limb)
            add(
                f"forearm {side}",
                (arm[0] - 0.02, outer, height),
                (arm[1] + 0.015, outer, height),
                0.0195 * limb,
            )
            add(f"hand {side}", (arm[1] - 0.01, outer, height), (arm[2], outer, height), 0.0135 * limb)
        else:
            add(f"upper arm {side}", (0.0, outer, build.shoulder), (0.0, outer, elbow - 0.02), 0.025 * limb)
            add(f"forearm {side}", (0.0, outer, elbow + 0.02), (0.0, outer, wrist - 0.015), 0.0195 * limb)
            add(f"hand {side}", (0.0, outer, wrist + 0.01), (0.0, outer, wrist - build.hand), 0.0135 * limb)
    return [_placed(person, *capsule) for capsule in found]


def _placed(person: Person, name: str, start: Array, end: Array, radius: float) -> PlacedCapsule:
    def place(point: Array) -> tuple[float, float, float]:
        x, y, z = (person.height * (point - [0.0, 0.0, 0.5])).tolist()
        return (-z, y, x) if person.posture == "lying" else (x, y, z)

    return PlacedCapsule(name, place(start), place(end), person.height * radius)


def objects(person: Person) -> str:
    """Returns the objects of a scene file, all one conductor."""
    return "\n".join(map(_object, capsules(person)))


def _object(capsule: PlacedCapsule) -> str:
    start, end = np.array(capsule.start), np.array(capsule.end)
    length = float(np.linalg.norm(end - start))
    along = (end - start) / length
    axis = np.cross([0.0, 0.0, 1.0], along)
    degrees = math.degrees(math.atan2(float(np.linalg.norm(axis)), float(along[2])))
    if not np.any(axis):
        axis = np.array([1.0, 0.0, 0.0])
    return (
        f'[[object]]\nname = "person {capsule.name}"\nconductor = "person"\n'
        f'shape = {{ type = "capsule", radius = {capsule.radius:.6g}, length = {length:.6g}, segments = {SEGMENTS} }}\n'
        f"translation = {np.round((start + end) / 2, 6).tolist()}\n"
        f"rotation = {{ axis = {np.round(axis, 6).tolist()}, degrees = {degrees:.6g} }}\n"
    )
