"""Round solids in the world frame: spheres, ellipsoids, cylinders, cones, arcs and what a ball sweeps; they are meshed curved, not faceted.

The rows of `axes` are the axes of the body's own frame. The axis of rotation is axes[2]; an arc is symmetric about axes[0].
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from geometries.common.arrays import Array


@dataclass(frozen=True)
class Placed:
    """A body with a frame of its own; lengths in metres."""

    name: str
    centre: Array
    axes: Array
    is_solid: ClassVar[bool] = True


@dataclass(frozen=True)
class Sphere:
    """A ball; lengths in metres."""

    name: str
    centre: Array
    radius: float
    is_solid: ClassVar[bool] = True

    @property
    def size(self) -> float:
        return 2 * self.radius

    @property
    def corners(self) -> Array:
        """The corners (8, 3) of the cube around the ball."""
        return _box(self.centre, np.eye(3), (self.radius, self.radius, self.radius))


@dataclass(frozen=True)
class Ellipsoid(Placed):
    """A solid ellipsoid with semi_axes[i] along axes[i]."""

    semi_axes: tuple[float, float, float]

    @property
    def size(self) -> float:
        return 2 * min(self.semi_axes)

    @property
    def corners(self) -> Array:
        """The corners (8, 3) of the box around the ellipsoid."""
        return _box(self.centre, self.axes, self.semi_axes)


@dataclass(frozen=True)
class Swept(Placed):
    """A box, centre ± core[i]·axes[i], swept by a ball; some of `core` may be 0, and a segment gives a capsule. Lengths in metres."""

    core: tuple[float, float, float]
    radius: float

    @property
    def size(self) -> float:
        return 2 * (min(self.core) + self.radius)

    @property
    def corners(self) -> Array:
        """The corners (8, 3) of the box around the body."""
        x, y, z = self.core
        return _box(self.centre, self.axes, (x + self.radius, y + self.radius, z + self.radius))

    @property
    def core_corners(self) -> Array:
        """The corners (n, 3) of the box that the ball sweeps: eight, four, two or one."""
        return np.unique(_box(self.centre, self.axes, self.core), axis=0)


@dataclass(frozen=True)
class _OnCircularBase(Placed):
    """A body of revolution around axes[2] on a circular base, from −height/2 to height/2; lengths in metres."""

    radius: float
    height: float

    @property
    def size(self) -> float:
        return min(2 * self.radius, self.height)

    @property
    def corners(self) -> Array:
        """The corners (8, 3) of the box around the body."""
        return _box(self.centre, self.axes, (self.radius, self.radius, self.height / 2))


@dataclass(frozen=True)
class Cylinder(_OnCircularBase):
    """A solid cylinder around axes[2], from −height/2 to height/2; lengths in metres."""


@dataclass(frozen=True)
class Cone(_OnCircularBase):
    """A solid cone around axes[2] with its base at −height/2 and its apex at height/2; lengths in metres."""


@dataclass(frozen=True)
class Arc(Placed):
    """A sector of a ring around axes[2], from −half_angle to half_angle about axes[0]; lengths in metres, angles in radians."""

    inner_radius: float
    outer_radius: float
    height: float
    half_angle: float

    @property
    def is_ring(self) -> bool:
        return self.half_angle >= math.pi

    @property
    def size(self) -> float:
        width = min(self.outer_radius - self.inner_radius, self.height)
        length = (self.inner_radius + self.outer_radius) * min(self.half_angle, math.pi)
        return min(width, length)

    @property
    def corners(self) -> Array:
        """The corners (8, 3) of the box around the sector."""
        low = min(math.cos(self.half_angle) * radius for radius in (self.inner_radius, self.outer_radius))
        high = self.outer_radius * math.sin(min(self.half_angle, math.pi / 2))
        middle = self.centre + (low + self.outer_radius) / 2 * self.axes[0]
        return _box(middle, self.axes, ((self.outer_radius - low) / 2, high, self.height / 2))


RoundBody = Sphere | Ellipsoid | Swept | Cylinder | Cone | Arc
ROUND_BODIES = (Sphere, Ellipsoid, Swept, Cylinder, Cone, Arc)


def _box(centre: Array, axes: Array, half_widths: tuple[float, float, float]) -> Array:
    """The corners (8, 3) of a box."""
    signs = np.array([[a, b, c] for c in (-1, 1) for b in (-1, 1) for a in (-1, 1)])
    return np.asarray(centre + (signs * np.asarray(half_widths)) @ axes)
