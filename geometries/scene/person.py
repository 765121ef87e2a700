"""A person: a closed surface on a lattice of cells, with the proportions of anthropometry. It made the meshes of
`geometries/people`, which fix vertices, order and orientation.

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
