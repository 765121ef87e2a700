"""Triangles that bound no solid as they are: they have to be wrapped before they can be meshed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_reference.bodies.shapes import Body

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Soup:
    """The triangles (m, 3, 3) of a body, in metres, and what keeps them from bounding a solid."""

    name: str
    triangles: Vector
    defect: str
    """Words that follow the name of the file."""

    @property
    def is_solid(self) -> bool:
        return False

    @property
    def corners(self) -> Vector:
        return np.asarray(self.triangles.reshape(-1, 3))

    @property
    def size(self) -> float:
        """The middle one of the widths of the bounding box, so that a sheet has a size as well."""
        return float(np.median(np.ptp(self.corners, axis=0)))

    def holds(self, points: Vector) -> NDArray[np.bool_]:
        """Whether each of the points (n, 3) is inside: the triangles, whatever their orientation as a whole, wind around it."""
        return np.asarray(np.abs(winding_number(self.triangles, points)) > 0.5)


Surface = Body | Soup
"""What a body is before it is known whether it has to be wrapped."""


def winding_number(triangles: Vector, points: Vector) -> Vector:
    """The solid angle (n,) that triangles (m, 3, 3) subtend at points (n, 3), over 4π (Van Oosterom & Strackee 1983)."""
    found = np.empty(len(points))
    for k, point in enumerate(points):
        a, b, c = (triangles[:, corner] - point for corner in range(3))
        ra, rb, rc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
        volume = np.einsum("ij,ij->i", a, np.cross(b, c))
        dots = [np.einsum("ij,ij->i", p, q) for p, q in ((a, b), (b, c), (c, a))]
        angle = 2 * np.arctan2(volume, ra * rb * rc + dots[0] * rc + dots[1] * ra + dots[2] * rb)
        found[k] = angle.sum() / (4 * np.pi)
    return found
