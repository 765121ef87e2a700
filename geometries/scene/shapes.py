"""The shapes of objects and their triangles, in the shape's own frame. SCENE.md fixes vertices, order and orientation."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from geometries.common.arrays import Array
from geometries.scene import polygons
from geometries.scene.person import Person

DEFAULT_SEGMENTS = 48

_CUBOID_QUADS = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


@dataclass(frozen=True)
class PlateShape:
    """A rectangle without thickness in z = 0, normal +z; `size` = (x, y) in metres."""

    size: tuple[float, float]

    def triangles(self) -> Array:
        """Returns two triangles (2, 3, 3)."""
        x, y = self.size[0] / 2, self.size[1] / 2
        return _quads(
            [
                np.array([[-x, -y, 0.0]]),
                np.array([[x, -y, 0.0]]),
                np.array([[x, y, 0.0]]),
                np.array([[-x, y, 0.0]]),
            ]
        )


@dataclass(frozen=True)
class Cuboid:
    """A solid box; `size` = (x, y, z) in metres. A cube is a cuboid of three equal sizes."""

    size: tuple[float, float, float]

    def triangles(self) -> Array:
        """Returns twelve triangles (12, 3, 3), two for each face."""
        vertices = (
            np.array([[a, b, c] for c in (-1, 1) for b in (-1, 1) for a in (-1, 1)])
            * np.asarray(self.size)
            / 2
        )
        return _quads([vertices[list(corner)] for corner in zip(*_CUBOID_QUADS)])


@dataclass(frozen=True)
class Cylinder:
    """A solid cylinder about z; metres; `segments` flat sides inscribed."""

    radius: float
    height: float
    segments: int = DEFAULT_SEGMENTS

    def triangles(self) -> Array:
        """Returns 4·segments triangles (n, 3, 3): per segment two of the side, one of the bottom, one of the top."""
        bottom, top = _ring(self.radius, -self.height / 2, self.segments), _ring(
            self.radius, self.height / 2, self.segments
        )
        bottom_next, top_next = np.roll(bottom, -1, axis=0), np.roll(top, -1, axis=0)
        low, high = _repeated((0, 0, -self.height / 2), self.segments), _repeated(
            (0, 0, self.height / 2), self.segments
        )
        return _interleaved(
            [
                (bottom, bottom_next, top_next),
                (bottom, top_next, top),
                (low, bottom_next, bottom),
                (high, top, top_next),
            ]
        )


@dataclass(frozen=True)
class Cone:
    """A solid cone about z, base at −height/2, apex at +height/2; metres; `segments` flat sides inscribed."""

    radius: float
    height: float
    segments: int = DEFAULT_SEGMENTS

    def triangles(self) -> Array:
        """Returns 2·segments triangles (n, 3, 3): per segment one of the side, one of the bottom."""
        base = _ring(self.radius, -self.height / 2, self.segments)
        base_next = np.roll(base, -1, axis=0)
        apex, low = _repeated((0, 0, self.height / 2), self.segments), _repeated(
            (0, 0, -self.height / 2), self.segments
        )
        return _interleaved([(base, base_next, apex), (low, base_next, base)])


@dataclass(frozen=True)
class Arc:
    """A ring sector about z from −degrees/2 to +degrees/2; metres; `segments` pieces inscribed."""

    inner_radius: float
    outer_radius: float
    height: float
    degrees: float
    segments: int = DEFAULT_SEGMENTS

    def triangles(self) -> Array:
        """Returns 8·segments triangles (n, 3, 3), and four for the two ends when the ring is open."""
        n = self.segments
        closed = self.degrees == 360
        angles = np.radians(self.degrees * (np.arange(n + 1) / n - 0.5))
        if closed:
            angles[n] = angles[0]
        circle = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(n + 1)])
        low, high = np.array([0, 0, -self.height / 2]), np.array([0, 0, self.height / 2])
        ib, ob = self.inner_radius * circle + low, self.outer_radius * circle + low
        it, ot = self.inner_radius * circle + high, self.outer_radius * circle + high
        quads = [
            (ob[:-1], ob[1:], ot[1:], ot[:-1]),
            (ib[1:], ib[:-1], it[:-1], it[1:]),
            (ib[:-1], ib[1:], ob[1:], ob[:-1]),
            (it[:-1], ot[:-1], ot[1:], it[1:]),
        ]
        triangles = _interleaved([half for p, q, r, s in quads for half in ((p, q, r), (p, r, s))])
        if closed:
            return triangles
        ends = [(ib[:1], ob[:1], ot[:1], it[:1]), (ob[n:], ib[n:], it[n:], ot[n:])]
        return np.concatenate([triangles, *(_quads(list(end)) for end in ends)])


@dataclass(frozen=True)
class Sphere:
    """A solid sphere; metres; `segments` meridians and half as many bands, vertices on the sphere."""

    radius: float
    segments: int = DEFAULT_SEGMENTS

    def triangles(self) -> Array:
        """Returns 2·segments·(bands − 1) triangles (n, 3, 3), from the north pole southwards."""
        return _ball(self.radius, self.segments)


@dataclass(frozen=True)
class Ellipsoid:
    """A solid ellipsoid with its axes along x, y and z; `semi_axes` in metres; meridians and bands as those of a sphere."""

    semi_axes: tuple[float, float, float]
    segments: int = DEFAULT_SEGMENTS

    def triangles(self) -> Array:
        """Returns as many triangles (n, 3, 3) as a sphere has, in their order."""
        return np.asarray(_ball(1.0, self.segments) * np.asarray(self.semi_axes))


@dataclass(frozen=True)
class Disc:
    """A disc without thickness in z = 0, normal +z; metres; `segments` sides inscribed."""

    radius: float
    segments: int = DEFAULT_SEGMENTS

    def triangles(self) -> Array:
        """Returns `segments` triangles (n, 3, 3) with the centre as their first vertex."""
        rim = _ring(self.radius, 0.0, self.segments)
        return _interleaved([(_repeated((0, 0, 0), self.segments), rim, np.roll(rim, -1, axis=0))])


@dataclass(frozen=True)
class Polygon:
    """A simple polygon without thickness in z = 0, normal +z; `vertices` (x, y) in metres, anticlockwise or clockwise."""

    vertices: tuple[polygons.Point, ...]

    def triangles(self) -> Array:
        """Returns n − 2 triangles (n − 2, 3, 3) for n vertices."""
        flat = np.array(polygons.ears(polygons.anticlockwise(self.vertices)))
        return np.concatenate([flat, np.zeros((*flat.shape[:2], 1))], axis=2)


@dataclass(frozen=True)
class Capsule:
    """A segment along z swept by a ball; metres. `length` is that of the segment, without the two half balls at its ends."""

    radius: float
    length: float
    segments: int = DEFAULT_SEGMENTS

    @property
    def core(self) -> tuple[float, float, float]:
        """Half the sizes (x, y, z) of what the ball sweeps."""
        return 0.0, 0.0, self.length / 2

    def triangles(self) -> Array:
        """Returns (4·(segments div 4))² triangles (n, 3, 3), from the top downwards."""
        return _swept(self.core, self.radius, self.segments)


@dataclass(frozen=True)
class RoundedCuboid:
    """A cuboid of outer `size` (x, y, z) whose edges and corners are round: a smaller cuboid swept by a ball of radius `rounding`; metres."""

    size: tuple[float, float, float]
    rounding: float
    segments: int = DEFAULT_SEGMENTS

    @property
    def core(self) -> tuple[float, float, float]:
        """Half the sizes (x, y, z) of what the ball sweeps; 0 where the rounding is half the size."""
        x, y, z = self.size
        return x / 2 - self.rounding, y / 2 - self.rounding, z / 2 - self.rounding

    def triangles(self) -> Array:
        """Returns the triangles (n, 3, 3), from the top downwards."""
        return _swept(self.core, self.rounding, self.segments)


@dataclass(frozen=True)
class MeshShape:
    """The triangles of a file, scaled.

    Two are equal when the bytes of their files (`digest`, sha256) and their scales are: where the file lies does not
    matter to any answer.
    """

    file: str = field(compare=False)
    digest: str
    scale: float
    surface: Array = field(compare=False, repr=False)
    remarks: tuple[str, ...] = field(default=(), compare=False, repr=False)
    """Sentences on the file's faces."""

    def triangles(self) -> Array:
        """Returns the file's triangles (n, 3, 3), scaled, in the file's order."""
        return np.asarray(self.scale * self.surface)


RoundShape = Cylinder | Cone | Arc | Sphere | Ellipsoid | Capsule | RoundedCuboid | Disc
ROUND_SHAPES = (Cylinder, Cone, Arc, Sphere, Ellipsoid, Capsule, RoundedCuboid, Disc)
"""The shapes whose triangles are only inscribed in the true surface."""
SHEETS = (PlateShape, Disc, Polygon)
"""The shapes without thickness."""
Shape = PlateShape | Cuboid | Polygon | RoundShape | MeshShape | Person


def _ring(radius: float, height: float, segments: int) -> Array:
    """Returns `segments` points on a circle about z, from the x axis anticlockwise."""
    angles = 2 * np.pi * np.arange(segments) / segments
    return np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.full(segments, height)])


def _ball(radius: float, segments: int) -> Array:
    """Returns the triangles of a sphere."""
    bands = max(2, segments // 2)
    polar = [math.pi * j / bands for j in range(1, bands)]
    rings = [_ring(radius * math.sin(angle), radius * math.cos(angle), segments) for angle in polar]
    following = [np.roll(ring, -1, axis=0) for ring in rings]
    north, south = _repeated((0, 0, radius), segments), _repeated((0, 0, -radius), segments)
    parts = [_interleaved([(north, rings[0], following[0])])]
    for upper, upper_next, lower, lower_next in zip(rings, following, rings[1:], following[1:]):
        parts.append(_interleaved([(upper, lower, lower_next), (upper, lower_next, upper_next)]))
    parts.append(_interleaved([(south, following[-1], rings[-1])]))
    return np.concatenate(parts)


def _swept(core: tuple[float, float, float], radius: float, segments: int) -> Array:
    """Returns the triangles of a box with these half sizes, some of which may be 0, swept by a ball: the order is that of SCENE.md.

    A row of the grid has one polar angle, a column one azimuth; each octant of the ball stands at a corner of the box. Triangles
    without area, at the poles of the octants and across sides of the box without length, are left out.
    """
    q = max(1, segments // 4)
    cosine = np.cos(np.pi / 2 * np.arange(q + 1) / q)
    cosine[q] = 0.0
    sine = cosine[::-1]
    along, beside = np.concatenate([sine, cosine]), np.concatenate([cosine, -sine])
    x = np.repeat([core[0], -core[0], -core[0], core[0]], q + 1)
    y = np.repeat([core[1], core[1], -core[1], -core[1]], q + 1)
    z = np.repeat([core[2], -core[2]], q + 1)
    rows, columns = 2 * q + 2, 4 * q + 4
    grid = np.empty((rows, columns, 3))
    grid[..., 0] = x + radius * along[:, None] * np.concatenate([cosine, -sine, -cosine, sine])
    grid[..., 1] = y + radius * along[:, None] * np.concatenate([sine, cosine, -sine, -cosine])
    grid[..., 2] = (z + radius * beside)[:, None]
    grid += 0.0  # The sum turns -0.0 into 0.0, so that equal corners have equal bits.
    following = np.roll(grid, -1, axis=1)
    p, t, r, s = grid[:-1], grid[1:], following[1:], following[:-1]
    quads = np.stack([np.stack([p, t, r], axis=2), np.stack([p, r, s], axis=2)], axis=2)
    i, j = np.arange(rows - 1)[:, None], np.arange(columns)
    across = np.array([core[0], core[1], core[0], core[1]])[j // (q + 1)]
    is_across = j % (q + 1) == q
    has_area = (~is_across | (across > 0)) & ((i != q) | (core[2] > 0))
    kept = np.stack([has_area & (is_across | (i < 2 * q)), has_area & (is_across | (i > 0))], axis=2)
    a, b, c, d = 0, q + 1, 2 * q + 2, 3 * q + 3
    caps = core[0] > 0 and core[1] > 0
    top = grid[0, [[a, b, c], [a, c, d]]][: caps * 2]
    bottom = grid[-1, [[a, c, b], [a, d, c]]][: caps * 2]
    return np.concatenate([top, quads[kept], bottom])


def _repeated(point: tuple[float, float, float], count: int) -> Array:
    return np.broadcast_to(np.asarray(point, dtype=np.float64), (count, 3))


def _interleaved(kinds: list[tuple[Array, Array, Array]]) -> Array:
    """Returns triangles for each k the first kind's, the second's, …; each kind is three vertex arrays (n, 3)."""
    return np.stack([np.stack(kind, axis=1) for kind in kinds], axis=1).reshape(-1, 3, 3)


def _quads(corners: list[Array]) -> Array:
    """Splits quads (p q r s), each corner an array (n, 3), into triangles (p q r), (p r s)."""
    p, q, r, s = corners
    return _interleaved([(p, q, r), (p, r, s)])
