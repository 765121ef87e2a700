"""The bodies of the field problem in the world frame: rectangles, discs and polygons without thickness, and solids.

Every body has a size, relative to which the mesh resolves it, corners and, where the charge density is singular, edges.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy.optimize import lsq_linear

from fem_reference.bodies.polyhedron import Polyhedron
from fem_reference.bodies.round_bodies import Placed, RoundBody
from fem_reference.bodies.triangle_distances import winding_number
from geometries.common.arrays import Array, Flags


@dataclass(frozen=True)
class Rectangle(Placed):
    """A plate without thickness: centre ± half_widths[i]·axes[i], with the normal axes[2]; lengths in metres."""

    half_widths: tuple[float, float]
    is_solid: ClassVar[bool] = False

    @property
    def size(self) -> float:
        """The shorter side (m), relative to which the mesh has to resolve the edge singularity."""
        return 2 * min(self.half_widths)

    @property
    def spans(self) -> Array:
        """Edge vectors (2, 3): the body is corners[0] + Σ s_i·spans[i] with s_i in [0, 1]."""
        return 2 * np.asarray(self.half_widths)[:, None] * self.axes[:2]

    @property
    def corners(self) -> Array:
        """The four corners (4, 3) in order around the rectangle."""
        u, v = self.spans
        origin = self.centre - (u + v) / 2
        return np.array([origin, origin + u, origin + u + v, origin + v])


@dataclass(frozen=True)
class Disc(Placed):
    """A circular plate without thickness, as in Love's equation, with the normal axes[2]; lengths in metres."""

    radius: float
    is_solid: ClassVar[bool] = False

    @property
    def size(self) -> float:
        return 2 * self.radius

    @property
    def corners(self) -> Array:
        """The corners (4, 3) of the square around the disc."""
        u, v = self.radius * self.axes[:2]
        return np.array([self.centre - u - v, self.centre + u - v, self.centre + u + v, self.centre - u + v])


@dataclass(frozen=True)
class PlanePolygon(Placed):
    """A simple polygon without thickness, with the normal axes[2]; lengths in metres."""

    outline: Array
    """The vertices (n, 2), anticlockwise, along axes[0] and axes[1] from `centre`."""
    ears: Array
    """The triangles (n − 2, 3, 2) that it consists of, in the same coordinates."""
    is_solid: ClassVar[bool] = False

    @property
    def size(self) -> float:
        """The diameter (m) of the circle with as much area over perimeter: a narrow polygon is as wide as twice this ratio."""
        u, v = self.ears[:, 1] - self.ears[:, 0], self.ears[:, 2] - self.ears[:, 0]
        doubled = float(np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum())
        sides = np.roll(self.outline, -1, axis=0) - self.outline
        return 2 * doubled / float(np.linalg.norm(sides, axis=1).sum())

    @property
    def corners(self) -> Array:
        """The vertices (n, 3)."""
        return np.asarray(self.centre + self.outline @ self.axes[:2])

    @property
    def triangles(self) -> Array:
        """The triangles (n − 2, 3, 3)."""
        return np.asarray(self.centre + self.ears @ self.axes[:2])


@dataclass(frozen=True)
class Cuboid(Placed):
    """A solid box: centre ± half_widths[i]·axes[i]; lengths in metres."""

    half_widths: tuple[float, float, float]

    @property
    def size(self) -> float:
        return 2 * min(self.half_widths)

    @property
    def spans(self) -> Array:
        """Edge vectors (3, 3): the body is corners[0] + Σ s_i·spans[i] with s_i in [0, 1]."""
        return 2 * np.asarray(self.half_widths)[:, None] * self.axes

    @property
    def corners(self) -> Array:
        """The eight corners (8, 3); corner number a + 2b + 4c is on the positive side of the axes whose bits a, b, c are 1."""
        u, v, w = self.spans
        origin = self.centre - (u + v + w) / 2
        return np.array([origin + a * u + b * v + c * w for c in (0, 1) for b in (0, 1) for a in (0, 1)])


Sheet = Rectangle | Disc | PlanePolygon
SHEETS = (Rectangle, Disc, PlanePolygon)
"""The bodies without thickness."""
Body = Sheet | Cuboid | RoundBody | Polyhedron


@dataclass(frozen=True)
class Soup:
    """The triangles (m, 3, 3) of a body, in metres, and what keeps them from bounding a solid."""

    name: str
    triangles: Array
    defect: str
    """Words that follow the name of the file."""
    is_solid: ClassVar[bool] = False

    @property
    def corners(self) -> Array:
        return np.asarray(self.triangles.reshape(-1, 3))

    @property
    def size(self) -> float:
        """The middle one of the widths of the bounding box, so that a sheet has a size as well."""
        return float(np.median(np.ptp(self.corners, axis=0)))

    def holds(self, points: Array) -> Flags:
        """Whether each of the points (n, 3) is inside: the triangles, whatever their orientation as a whole, wind around it."""
        return np.asarray(np.abs(winding_number(self.triangles, points)) > 0.5)


Surface = Body | Soup
"""What a body is before it is known whether it has to be wrapped."""


def rectangle(name: str, corner: Array, edge_u: Array, edge_v: Array) -> Rectangle:
    """The rectangle corner + a·edge_u + b·edge_v with a and b in [0, 1]; the edges are at right angles, lengths in metres."""
    widths = float(np.linalg.norm(edge_u)), float(np.linalg.norm(edge_v))
    first, second = edge_u / widths[0], edge_v / widths[1]
    axes = np.array([first, second, np.cross(first, second)])
    return Rectangle(name, corner + (edge_u + edge_v) / 2, axes, (widths[0] / 2, widths[1] / 2))


def bounding_sphere(bodies: Sequence[Body]) -> tuple[Array, float]:
    """Centre (3,) and radius (m) of a sphere around all bodies; its centre is that of their bounding box."""
    corners = np.concatenate([body.corners for body in bodies])
    centre = (corners.min(axis=0) + corners.max(axis=0)) / 2
    return centre, float(np.linalg.norm(corners - centre, axis=1).max())


def separation(first: Rectangle | Cuboid, second: Rectangle | Cuboid) -> float:
    """The shortest distance (m) between two bodies; 0 when they touch or overlap.

    Both bodies are parallelotopes, so that this is a least-squares problem for the coefficients of the edge vectors, bounded by 0 and 1.
    """
    scale = max(np.abs(first.spans).max(), np.abs(second.spans).max())
    matrix = np.vstack([first.spans, -second.spans]).T / scale
    offset = (second.corners[0] - first.corners[0]) / scale
    solution = lsq_linear(matrix, offset, bounds=(0, 1), method="bvls", tol=1e-14)
    return float(np.linalg.norm(matrix @ solution.x - offset) * scale)
