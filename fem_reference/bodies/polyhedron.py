"""Solids bounded by triangles, from mesh files: checks that the triangles bound a solid, and finds its sharp edges."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull, cKDTree

from fem_reference.bodies.triangle_distances import segment_distances, winding_number
from geometries.common.arrays import Array, Flags, Indices

MOST_NORMALS = 5000
"""Largest number of triangles whose normals are tried to find the smallest width of a solid."""
SAME_POINT = 1e-6
"""Largest distance of vertices that are merged, over the surface's extent: mesh files keep single precision."""
SHARP_DEGREES = 30.0
"""Least angle (degrees) between the normals of two faces at an edge towards which the mesh is refined. At flatter edges, those of
faceted round surfaces, the singularity is weaker than 0.15 in the power of the distance."""

FLAT_DEGREES = 0.05
"""Largest angle (degrees) between the normals of triangles in one plane face. Rounding to single precision turns small triangles by
less, and no faceted round surface that is meshed as it is has angles as small."""


class NotASolid(ValueError):
    """Raised for triangles that do not bound a solid; the message says why and where."""


@dataclass(frozen=True)
class Polyhedron:
    """A solid bounded by triangles, each anticlockwise seen from outside; lengths in metres."""

    name: str
    vertices: Array
    """(n, 3)."""
    triangles: Indices
    """(m, 3): numbers of vertices."""
    parts: tuple[Indices, ...]
    """The numbers of the triangles that bound each of the solid's parts, which do not touch each other."""
    size: float
    """The smallest width of a part at right angles to one of its faces."""
    is_solid: ClassVar[bool] = True

    @property
    def corners(self) -> Array:
        return self.vertices

    @property
    def edges(self) -> Indices:
        """The sharp convex edges, where the charge density is singular, as numbers of vertices (k, 2)."""
        corners = self.vertices[self.triangles]
        pairs, faces, angle = self.folds
        outward = corners[faces[:, 1]].mean(axis=1) - corners[faces[:, 0]].mean(axis=1)
        convex = np.einsum("ij,ij->i", outward, _normals(corners)[faces[:, 0]]) < 0
        return np.asarray(pairs[convex & (angle > SHARP_DEGREES)])

    @property
    def rounded(self) -> Flags:
        """Which triangles (m,) belong to a faceted round surface: those that meet others at an angle neither flat nor sharp."""
        _, faces, angle = self.folds
        found = np.zeros(len(self.triangles), dtype=bool)
        found[faces[(angle > FLAT_DEGREES) & (angle <= SHARP_DEGREES)]] = True
        return found

    @property
    def folds(self) -> tuple[Indices, Indices, Array]:
        """All edges (k, 2), the two triangles (k, 2) at each edge, and the angle (k,) in degrees between their normals."""
        normals = _normals(self.vertices[self.triangles])
        pairs, faces = _edges_with_faces(self.triangles)
        cosine = np.einsum("ij,ij->i", normals[faces[:, 0]], normals[faces[:, 1]])
        sine = np.linalg.norm(np.cross(normals[faces[:, 0]], normals[faces[:, 1]]), axis=1)
        return pairs, faces, np.degrees(np.arctan2(sine, cosine))

    def holds(self, points: Array) -> Flags:
        """Whether each of the points (n, 3) is inside: the surface subtends the solid angle 4π there, and 0 outside."""
        return np.asarray(winding_number(self.vertices[self.triangles], points) > 0.5)


def polyhedron(name: str, triangles: Array) -> Polyhedron:
    """The solid that triangles (m, 3, 3) bound, each anticlockwise seen from outside.

    Vertices in the same place are merged, and triangles of which only two vertices remain are dropped. Raises NotASolid when the
    surface is open, meets itself or has cavities, or when its triangles are not oriented consistently or are inside out.
    """
    extent = float(np.ptp(triangles.reshape(-1, 3), axis=0).max())
    vertices, corners = _merged(triangles, SAME_POINT * extent)
    corners = corners[
        (corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2]) & (corners[:, 2] != corners[:, 0])
    ]
    if len(corners) == 0:
        raise NotASolid("has no triangle with an area")
    _refuse_needles(vertices[corners], SAME_POINT * extent)
    _refuse_open(vertices, corners)
    parts = connected_parts(corners)
    for part in parts:
        if signed_volume(vertices[corners[part]]) <= 0:
            where = _place(vertices[corners[part]].mean(axis=(0, 1)))
            if _is_cavity(vertices[corners], part):
                raise NotASolid(f"has a cavity around {where}, which is not meshed")
            raise NotASolid(
                f"is inside out around {where}: its triangles must be anticlockwise seen from outside"
            )
    _refuse_crossing(vertices, corners, SAME_POINT * extent)
    return Polyhedron(name, vertices, corners, tuple(parts), smallest_width(vertices, corners, parts))


def smallest_width(vertices: Array, corners: Indices, parts: Sequence[Indices]) -> float:
    """The smallest width of one of the parts at right angles to one of its faces."""
    return min(_least_extent(vertices[corners[part]]) for part in parts)


def connected_parts(corners: Indices) -> list[Indices]:
    """The connected components of the surface: groups of triangles connected by common vertices."""
    count = len(corners)
    ends = np.column_stack([np.repeat(np.arange(count), 3), count + corners.ravel()])
    label = connected(count + int(corners.max()) + 1, ends)[:count]
    return [np.flatnonzero(label == part) for part in range(label.max() + 1)]


def connected(count: int, pairs: Indices) -> Indices:
    """The number (count,) of the group of each of some things, where the two of each of the pairs (n, 2) are in one; groups follow their first
    members."""
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def _merged(triangles: Array, tolerance: float) -> tuple[Array, Indices]:
    """Merge vertices within `tolerance`: returns the vertices (n, 3) and the triangles as their numbers (m, 3)."""
    points = triangles.reshape(-1, 3)
    close = cKDTree(points).query_pairs(tolerance, output_type="ndarray")
    _, first, numbers = np.unique(connected(len(points), close), return_index=True, return_inverse=True)
    return points[first], numbers.reshape(-1, 3).astype(np.int64)


def _refuse_needles(triangles: Array, tolerance: float) -> None:
    """Raise NotASolid when a vertex of a triangle lies on the opposite side, so that the triangle has no area."""
    sides = np.linalg.norm(np.roll(triangles, -1, axis=1) - triangles, axis=2).max(axis=1)
    cross = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    flat = np.linalg.norm(cross, axis=1) <= tolerance * sides
    if flat.any():
        raise NotASolid(f"has a triangle without area around {_place(triangles[flat.argmax()].mean(axis=0))}")


def _refuse_open(vertices: Array, corners: Indices) -> None:
    """Raise NotASolid unless every directed edge occurs exactly once, and once in the other direction."""
    directed = corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    known, count = np.unique(directed, axis=0, return_counts=True)
    if count.max() > 1:
        edge = known[count.argmax()]
        both = np.count_nonzero((np.sort(directed, axis=1) == np.sort(edge)).all(axis=1))
        middle = _place(vertices[edge].mean(axis=0))
        if both == 2:
            raise NotASolid(f"has neighbouring triangles of opposite orientation at the edge around {middle}")
        raise NotASolid(f"has {both} triangles at the edge around {middle}, where a solid has two")
    present = set(map(tuple, directed.tolist()))
    for start, end in directed.tolist():
        if (end, start) not in present:
            raise NotASolid(f"is open at the edge around {_place(vertices[[start, end]].mean(axis=0))}")


def _refuse_crossing(vertices: Array, corners: Indices, tolerance: float) -> None:
    """Raise NotASolid when an edge of a triangle meets another triangle with which it shares no vertex."""
    pairs = np.array(list(_close_pairs(vertices[corners])), dtype=np.int64).reshape(-1, 2)
    for edge in ((0, 1), (1, 2), (2, 0)):
        for one, other in ((0, 1), (1, 0)):
            ends = corners[pairs[:, one]][:, edge]
            opposite = corners[pairs[:, other]]
            shared = (ends[:, :, None] == opposite[:, None]).any(axis=2).any(axis=1)
            ends, opposite, named = ends[~shared], opposite[~shared], pairs[~shared]
            met = segment_distances(vertices[ends], vertices[opposite]) <= tolerance
            if met.any():
                place = _place(vertices[ends[met.argmax()]].mean(axis=0))
                first, second = named[met.argmax()].tolist()
                raise NotASolid(f"meets itself around {place}: triangles {first} and {second}")


def _close_pairs(triangles: Array) -> Iterator[tuple[int, int]]:
    """Pairs of triangles whose bounding boxes meet."""
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    for k in range(len(triangles) - 1):
        meets = (low[k + 1 :] <= high[k]).all(axis=1) & (high[k + 1 :] >= low[k]).all(axis=1)
        yield from ((k, k + 1 + int(other)) for other in np.flatnonzero(meets))


def _edges_with_faces(corners: Indices) -> tuple[Indices, Indices]:
    """The edges (k, 2) of a closed surface and the two triangles (k, 2) at each."""
    directed = np.sort(corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    face = np.repeat(np.arange(len(corners)), 3)
    order = np.lexsort((directed[:, 1], directed[:, 0]))
    return directed[order][::2], face[order].reshape(-1, 2)


def _normals(triangles: Array) -> Array:
    """Unit normals (m, 3) of triangles (m, 3, 3)."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return np.asarray(normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300))


def _is_cavity(triangles: Array, part: Indices) -> bool:
    """Whether a part of a closed surface (m, 3, 3), whose triangles face inwards, is inside of the rest."""
    rest = np.delete(triangles, part, axis=0)
    return bool(len(rest) and (winding_number(rest, triangles[part[:1], 0]) > 0.5).all())


def signed_volume(triangles: Array) -> float:
    """The signed volume that a closed surface bounds; negative when it is inside out."""
    centred = triangles - triangles.mean(axis=(0, 1))
    return float(np.einsum("ij,ij->", centred[:, 0], np.cross(centred[:, 1], centred[:, 2])) / 6)


def _least_extent(triangles: Array) -> float:
    """The smallest distance between two planes parallel to one of the triangles with the whole surface between them.

    Of more than MOST_NORMALS triangles, that many of the largest ones are tried.
    """
    normals, points = _normals(triangles), triangles.reshape(-1, 3)
    if len(normals) > MOST_NORMALS:
        doubled = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        normals = normals[np.argsort(-np.linalg.norm(doubled, axis=1), kind="stable")[:MOST_NORMALS]]
        points = points[ConvexHull(points).vertices]
    widths = [
        float(np.ptp(points @ some.T, axis=0).min())
        for some in np.array_split(normals, 1 + len(normals) // 500)
    ]
    return min(widths)


def _place(point: Array) -> str:
    """The coordinates of a point as text for messages."""
    return "(" + ", ".join(f"{coordinate:.4g}" for coordinate in point) + ") m"
