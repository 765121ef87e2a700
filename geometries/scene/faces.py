"""Divides the faces of meshes, polygons of three or more corners in space, into triangles. SCENE.md fixes their order.

A face is seen along the axis in which the areas of its fan are largest: that leaves its other two coordinates as they are, so that every decision
about the outline is exact.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometries.common.arrays import Array, Flags, Indices
from geometries.scene import polygons

_LARGEST_BEND = 1e-3
"""Distance of corners from their plane, over the longest side of the face's box, that is no remark: coordinates of a few digits have it."""
_CROSSING = 1e-9
"""Twice the area of a triangle that faces the wrong way, over the square of this side, that is no remark: that of rounding."""


@dataclass(frozen=True)
class Surface:
    """The triangles (n, 3, 3) of a file's faces, in their order, and what is remarkable about the faces."""

    triangles: Array
    bent: int = 0
    """Number of faces whose corners are not in a plane."""
    bend: float = 0.0
    """How far these are from being in a plane, at most, in the file's unit."""
    crossing: int = 0
    """Number of faces whose outline crosses itself."""

    def remarks(self, scale: float) -> tuple[str, ...]:
        """Returns sentences on the faces; `scale` is the file's unit in metres."""
        found = []
        if self.bent:
            found.append(
                f"faces whose corners are not in one plane: {self.bent}, by up to {scale * self.bend:.2g} m; triangles would say which "
                "surface is meant"
            )
        if self.crossing:
            found.append(
                f"faces whose outline crosses itself: {self.crossing}; triangles would say which surface is meant"
            )
        return tuple(found)


def name_points(faces: Sequence[Sequence[int]], count: int) -> bool:
    """Tells whether all indices of faces are those of points, of which there are so many."""
    return all(0 <= corner < count for face in faces for corner in face)


def divided(points: Array, faces: Sequence[Sequence[int]]) -> Surface:
    """Returns the triangles of faces, lists of three or more indices of the points (n, 3)."""
    counts = np.array([len(face) for face in faces], dtype=np.int64)
    begins = np.concatenate([[0], np.cumsum(counts - 2)])
    corners = np.empty((begins[-1], 3), dtype=np.int64)
    bent, bend, crossing = 0, 0.0, 0
    for count in np.unique(counts):
        chosen = np.flatnonzero(counts == count)
        outlines = np.array([faces[face] for face in chosen])
        fans = np.stack(
            [np.broadcast_to(outlines[:, :1], outlines[:, 2:].shape), outlines[:, 1:-1], outlines[:, 2:]],
            axis=2,
        )
        if count > 3:
            found = _Polygons(points[outlines])
            for row in np.flatnonzero(~found.is_fan()):
                triangles, crosses = found.ears(row)
                fans[row] = outlines[row][triangles]
                crossing += crosses
            bends = found.bends()
            bent += len(bends)
            bend = max(bend, *bends, 0.0)
        corners[begins[chosen][:, None] + np.arange(count - 2)] = fans
    return Surface(np.asarray(points[corners]), bent, bend, crossing)


class _Polygons:
    """Faces (m, n, 3) of the same number of corners, n > 3."""

    def __init__(self, faces: Array) -> None:
        with np.errstate(all="ignore"):  # Faces that reach beyond all numbers are decided exactly.
            sides = faces - faces[:, :1]
            self._area, extent = np.zeros((len(faces), 3)), np.zeros((len(faces), 3))
            for k in range(1, faces.shape[1] - 1):
                (ax, ay, az), (bx, by, bz) = sides[:, k].T, sides[:, k + 1].T
                part = np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=1)
                self._area += part
                extent += np.abs(part)
            self._sides = sides
            self._size = np.ptp(faces, axis=1).max(axis=1)
        axis = np.zeros(len(faces), dtype=np.int64)
        rows = np.arange(len(faces))
        for other in (1, 2):
            axis[extent[:, other] > extent[rows, axis]] = other
        # Seen from the side to which the area points, the face is anticlockwise.
        first, second = (axis + 1) % 3, (axis + 2) % 3
        turned = self._area[rows, axis] < 0
        first, second = np.where(turned, second, first), np.where(turned, first, second)
        self._seen = np.stack([faces[rows, :, first], faces[rows, :, second]], axis=2)

    def is_fan(self) -> Flags:
        """Tells which faces (m,) are covered by the triangles of their first corner, all of which turn left."""
        a, b, c = self._seen[:, :1], self._seen[:, 1:-1], self._seen[:, 2:]
        with np.errstate(all="ignore"):
            doubled, bound = polygons.turn_and_bound(
                a[..., 0], a[..., 1], b[..., 0], b[..., 1], c[..., 0], c[..., 1]
            )
            is_left = doubled > bound
            for row, k in np.argwhere(~(np.abs(doubled) > bound)):
                is_left[row, k] = polygons.turn(_point(a[row, 0]), _point(b[row, k]), _point(c[row, k])) > 0
        return np.asarray(is_left.all(axis=1))

    def ears(self, row: int) -> tuple[Indices, bool]:
        """Returns the triangles (n − 2, 3) of a face by clipping ears, as indices of its corners, and whether its outline crosses itself."""
        outline = [_point(corner) for corner in self._seen[row]]
        found, rest = polygons.clipped(outline)
        fan = [(rest[0], here, after) for here, after in zip(rest[1:], rest[2:])]
        crosses = any(
            self._turns_right(outline[i], outline[j], outline[k], row) for i, j, k in fan or found[-1:]
        )
        return np.array(found + fan), crosses

    def _turns_right(self, a: polygons.Point, b: polygons.Point, c: polygons.Point, row: int) -> bool:
        doubled, _ = polygons.turn_and_bound(*a, *b, *c)
        return bool(-doubled > _CROSSING * self._size[row] * self._size[row])

    def bends(self) -> list[float]:
        """Returns how far the corners of the faces that are not plane are from a plane."""
        with np.errstate(all="ignore"):
            (nx, ny, nz), (x, y, z) = self._area.T, np.moveaxis(self._sides, 2, 0)
            length = np.sqrt(nx * nx + ny * ny + nz * nz)
            heights = (nx[:, None] * x + ny[:, None] * y + nz[:, None] * z) / length[:, None]
            ranges = np.ptp(heights, axis=1)
            return [float(bend) for bend in ranges[ranges > _LARGEST_BEND * self._size]]


def _point(pair: Array) -> polygons.Point:
    return float(pair[0]), float(pair[1])
