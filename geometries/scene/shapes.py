"""The shapes of objects and their triangles, in the shape's own frame. SCENE.md fixes vertices, order and orientation."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

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
        n = self.segments
        bands = max(2, n // 2)
        polar = [math.pi * j / bands for j in range(1, bands)]
        rings = [_ring(self.radius * math.sin(angle), self.radius * math.cos(angle), n) for angle in polar]
        following = [np.roll(ring, -1, axis=0) for ring in rings]
        north, south = _repeated((0, 0, self.radius), n), _repeated((0, 0, -self.radius), n)
        parts = [_interleaved([(north, rings[0], following[0])])]
        for upper, upper_next, lower, lower_next in zip(rings, following, rings[1:], following[1:]):
            parts.append(_interleaved([(upper, lower, lower_next), (upper, lower_next, upper_next)]))
        parts.append(_interleaved([(south, following[-1], rings[-1])]))
        return np.concatenate(parts)


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

    def triangles(self) -> Array:
        """Returns the file's triangles (n, 3, 3), scaled, in the file's order."""
        return np.asarray(self.scale * self.surface)


Shape = PlateShape | Cuboid | Cylinder | Cone | Arc | Sphere | MeshShape


def _ring(radius: float, height: float, segments: int) -> Array:
    """Returns `segments` points on a circle about z, from the x axis anticlockwise."""
    angles = 2 * np.pi * np.arange(segments) / segments
    return np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.full(segments, height)])


def _repeated(point: tuple[float, float, float], count: int) -> Array:
    return np.broadcast_to(np.asarray(point, dtype=np.float64), (count, 3))


def _interleaved(kinds: list[tuple[Array, Array, Array]]) -> Array:
    """Returns triangles for each k the first kind's, the second's, …; each kind is three vertex arrays (n, 3)."""
    return np.stack([np.stack(kind, axis=1) for kind in kinds], axis=1).reshape(-1, 3, 3)


def _quads(corners: list[Array]) -> Array:
    """Splits quads (p q r s), each corner an array (n, 3), into triangles (p q r), (p r s)."""
    p, q, r, s = corners
    return _interleaved([(p, q, r), (p, r, s)])
