"""A person: a closed surface on a lattice of cells, with the proportions of anthropometry. It made the meshes of
`geometries/people`, which fix vertices, order and orientation. Or capsules: one for each segment of the body, three for the trunk; they
overlap at the joints and are one conductor.

All lengths in the tables are fractions of the height. Heights of landmarks and lengths of limbs of the adult are those of Drillis and
Contini (1966), as in Winter, Biomechanics and Motor Control of Human Movement, figure 4.1; its cross-sections give the segments about the
volumes of table 4.1 there. Child (6 years) and infant (1 kg, 36 cm, born in the 27th week) have the head circumference, and about the
mass, of the growth charts (CDC 2000; Fenton and Kim 2013), and shorter legs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from geometries.common.arrays import Array

Point = tuple[int, int, int]
"""A point (i, j, k) of the lattice: i towards the left, j forwards, k upwards."""


@dataclass(frozen=True)
class Build:
    """The proportions of an age."""

    ankle: float
    knee: float
    crotch: float
    shoulder: float
    chin: float
    upper_arm: float
    forearm: float
    hand: float
    trunk_width: float
    """Cross-sections of the trunk over the adult's, like the next two."""
    head_width: float
    limb_width: float


BUILDS = {
    "adult": Build(0.039, 0.285, 0.475, 0.818, 0.870, 0.186, 0.146, 0.108, 1.05, 1.0, 1.05),
    "child": Build(0.039, 0.265, 0.450, 0.795, 0.840, 0.175, 0.135, 0.100, 1.03, 1.4, 1.03),
    "infant": Build(0.039, 0.200, 0.350, 0.705, 0.750, 0.165, 0.130, 0.100, 1.16, 2.15, 1.16),
}
POSTURES = ("standing", "lying", "arm_stretched")
SEGMENTS = 12
"""Sides of each capsule's triangles."""

# Rings. Trunk: share of the way from crotch to shoulder, half breadth, half depth.
_TRUNK = (
    (0.0, 0.088, 0.060),
    (0.16, 0.0955, 0.070),
    (0.42, 0.088, 0.063),
    (0.62, 0.092, 0.066),
    (0.78, 0.098, 0.070),
    (0.9, 0.098, 0.066),
    (1.0, 0.080, 0.045),
)
# Neck and head: share from shoulder to chin, share from chin to top, half breadth, half depth, centre forwards.
_HEAD = (
    (0.35, 0.0, 0.031, 0.033, 0.0),
    (1.0, 0.0, 0.030, 0.037, 0.010),
    (1.0, 0.35, 0.0437, 0.054, 0.006),
    (1.0, 0.7, 0.0437, 0.0555, 0.004),
    (1.0, 1.0, 0.022, 0.028, 0.0),
)
# Leg: shares from crotch to knee, from knee to ankle and from ankle to sole, half breadth, half depth, centres to the left and forwards.
_LEG = (
    (0.16, 0.0, 0.0, 0.0435, 0.046, 0.046, 0.0),
    (0.5, 0.0, 0.0, 0.038, 0.040, 0.047, 0.0),
    (1.0, 0.0, 0.0, 0.030, 0.032, 0.047, 0.0),
    (1.0, 0.3, 0.0, 0.031, 0.033, 0.047, -0.004),
    (1.0, 0.95, 0.0, 0.019, 0.022, 0.047, -0.008),
    (1.0, 1.0, 0.3, 0.025, 0.058, 0.049, 0.026),
    (1.0, 1.0, 1.0, 0.0275, 0.076, 0.050, 0.035),
)
# Arm: shares of upper arm, forearm and hand down from the shoulder, and forwards if stretched out; half axes forwards and outwards.
_ARM = (
    (0.18, 0.05, 0.0, 0.0, 0.034, 0.032),
    (0.39, 0.24, 0.0, 0.0, 0.027, 0.026),
    (0.63, 0.54, 0.0, 0.0, 0.025, 0.025),
    (1.0, 1.0, 0.0, 0.0, 0.022, 0.021),
    (1.0, 1.0, 0.3, 0.0, 0.023, 0.021),
    (1.0, 1.0, 1.0, 0.0, 0.016, 0.012),
    (1.0, 1.0, 1.0, 0.35, 0.024, 0.009),
    (1.0, 1.0, 1.0, 1.0, 0.012, 0.006),
)
# Arm: centre to the left; sine and cosine by which a ring has turned from facing left to facing down or, stretched out, forwards.
_HANGING = ((0.125, 0.6, 0.8), (0.137, 0.8, 0.6), (0.143, 1, 0), (0.150, 1, 0), (0.153, 1, 0), (0.158, 1, 0), (0.160, 1, 0), (0.162, 1, 0))  # fmt: skip
_STRETCHED = ((0.122, 0.6, 0.8), (0.140, 0.96, 0.28), (0.142, 1, 0), (0.142, 1, 0), (0.142, 1, 0), (0.142, 1, 0), (0.142, 1, 0), (0.142, 1, 0))  # fmt: skip
_SHOULDER_BREADTH = 0.098
"""Half the breadth of the trunk where the arms begin, of an adult."""
_CORNERS = [(b, a, c) for c in (0, 1) for b in (0, 1) for a in (0, 1)]
"""The corners of a cell as steps (j, i, k), forwards first."""
_FACES = [
    ((0, 0, -1), (0, 2, 3, 1)),
    ((0, 0, 1), (4, 5, 7, 6)),
    ((-1, 0, 0), (0, 1, 5, 4)),
    ((1, 0, 0), (2, 6, 7, 3)),
    ((0, -1, 0), (0, 4, 6, 2)),
    ((0, 1, 0), (1, 3, 7, 5)),
]
"""The neighbour (i, j, k) across each face of a cell, and its corners; in the order of a cuboid's faces."""


@dataclass(frozen=True)
class Person:
    """A person of a `height` in metres, centred at the origin; a closed polyhedron.

    Standing along z with the face towards +x, or `lying` on the back, the head towards −x and the face towards +z. `arm_stretched` stands
    and stretches the right arm, at −y, out forwards.
    """

    height: float
    age: str = "adult"
    posture: str = "standing"

    def triangles(self) -> Array:
        """Returns the triangles (788, 3, 3), two for each face of the lattice's cells that has no neighbour."""
        quads = []
        cells = _cells()
        inside = set(cells)
        for i, j, k in cells:
            for (di, dj, dk), corners in _FACES:
                if (i + di, j + dj, k + dk) not in inside:
                    steps = [_CORNERS[corner] for corner in corners]
                    quads.append([self._place((i + a, j + b, k + c)) for a, b, c in steps])
        points = self.height * np.array(quads)
        return points[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3, 3)

    def _place(self, point: Point) -> tuple[float, float, float]:
        """Returns where a point of the lattice lies for a height of 1."""
        i, j, k = point
        if i < 0 or (k < 0 and i < 3):
            x, y, z = self._left((5 - i, j, k), i < 0 and self.posture == "arm_stretched")
            y = -y
        else:
            x, y, z = self._left(point, False)
        z -= 0.5
        return (-z, y, x) if self.posture == "lying" else (x, y, z)

    def _left(self, point: Point, is_stretched: bool) -> tuple[float, float, float]:
        """Returns where a point of trunk, head, left leg or left arm lies above the soles."""
        i, j, k = point
        build = BUILDS[self.age]
        if i > 5:
            return _arm(build, i - 6, j - 1, k - 5, is_stretched)
        if k < 0:
            thigh, shank, foot, breadth, depth, left, forwards = _LEG[-k - 1]
            z = build.crotch - thigh * (build.crotch - build.knee)
            z -= shank * (build.knee - build.ankle) + foot * build.ankle
            width = build.limb_width
            u, v = _disc(i - 4, j - 1)
            return width * (forwards + depth * v), width * (left + breadth * u), z
        if k > 6:
            neck, head, breadth, depth, forwards = _HEAD[k - 7]
            z = build.shoulder + neck * (build.chin - build.shoulder) + head * (1 - build.chin)
            u, v = _disc((2 * i - 5) / 3, j - 1)
            return build.head_width * (forwards + depth * v), build.head_width * breadth * u, z
        share, breadth, depth = _TRUNK[k]
        u, v = _disc((2 * i - 5) / 5, j - 1)
        z = build.crotch + share * (build.shoulder - build.crotch)
        return build.trunk_width * depth * v, build.trunk_width * breadth * u, z


def _arm(build: Build, ring: int, j: int, k: int, is_stretched: bool) -> tuple[float, float, float]:
    """Returns where a point of the left arm lies above the soles; j and k are from −1 to 1."""
    down, ahead, forearm, hand, half_h, half_n = _ARM[ring]
    left, sine, cosine = (_STRETCHED if is_stretched else _HANGING)[ring]
    v, w = _disc(j, k)
    h, n = build.limb_width * half_h * v, build.limb_width * half_n * w
    y = _SHOULDER_BREADTH * build.trunk_width + (left - _SHOULDER_BREADTH) * build.limb_width
    beyond = forearm * build.forearm + hand * build.hand
    if is_stretched:
        x = ahead * build.upper_arm + beyond
        return x + cosine * h, y - sine * h, build.shoulder - _ARM[0][0] * build.upper_arm + n
    z = build.shoulder - down * build.upper_arm - beyond
    return h, y + sine * n, z + cosine * n


def _disc(u: float, v: float) -> tuple[float, float]:
    """Maps the square [−1, 1]² to the unit disc, its sides to arcs of the circle."""
    return u * math.sqrt(1 - v * v / 2), v * math.sqrt(1 - u * u / 2)


def _cells() -> list[Point]:
    """Returns the cells (i, j, k) of trunk, head, right and left leg, right and left arm, each cell by its lowest corner."""
    return [
        *((i, j, k) for k in range(6) for j in range(2) for i in range(5)),
        *((i, j, k) for k in range(6, 11) for j in range(2) for i in range(1, 4)),
        *(
            (i, j, k)
            for side in (0, 3)
            for k in range(-1, -8, -1)
            for j in range(2)
            for i in (side, side + 1)
        ),
        *((i, j, k) for i in range(-1, -9, -1) for j in range(2) for k in (4, 5)),
        *((i, j, k) for i in range(5, 13) for j in range(2) for k in (4, 5)),
    ]


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


def capsule_objects(person: Person) -> str:
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
