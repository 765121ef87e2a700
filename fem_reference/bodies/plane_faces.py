"""Merges neighbouring triangles in one plane into one face, so that the mesh need not follow the triangles of plane faces."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from fem_reference.bodies.polyhedron import FLAT_DEGREES, Polyhedron
from geometries.common.arrays import Array, Indices

Face = list[list[int]]
"""Loops of vertex numbers: first the outline, then the holes."""

IN_PLANE = 1e-9
"""Largest distance of a face's vertices from its plane, over the body's extent. OpenCASCADE's own tolerance is 1e-7."""


def plane_faces(body: Polyhedron) -> list[list[Face]]:
    """The faces of every part. Triangles that do not form a simple plane face, as in rounded data, stay faces of their own."""
    label = _coplanar_groups(body)
    faces = [
        [face for group in np.unique(label[part]) for face in _faces_of(body, np.flatnonzero(label == group))]
        for part in body.parts
    ]
    inside_edges = _vertices_inside_edges(body, [loop for part in faces for face in part for loop in face])
    return [
        [[[k for k in loop if k not in inside_edges] for loop in face] for face in part] for part in faces
    ]


def _coplanar_groups(body: Polyhedron) -> Indices:
    """A label for each triangle (m,), equal for triangles that a path over flat edges connects."""
    _, sides, angle = body.folds
    sides = sides[angle <= FLAT_DEGREES]
    count = len(body.triangles)
    graph = coo_array((np.ones(len(sides)), (sides[:, 0], sides[:, 1])), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def _faces_of(body: Polyhedron, group: Indices) -> list[Face]:
    """The triangles of a group as one face if they form one, else each triangle as a face."""
    triangles: list[list[int]] = body.triangles[group].tolist()
    separate = [[triangle] for triangle in triangles]
    if len(group) == 1:
        return separate
    corners = body.vertices[body.triangles[group]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).sum(axis=0)
    normal /= np.linalg.norm(normal)
    if np.ptp(corners.reshape(-1, 3) @ normal) > IN_PLANE * np.ptp(body.vertices, axis=0).max():
        return separate
    loops = _outlines(triangles)
    if loops is None:
        return separate
    areas = [_area(body.vertices[loop], normal) for loop in loops]
    if sum(area > 0 for area in areas) != 1:
        return separate
    return [[loops[k] for k in np.argsort(areas)[::-1]]]


def _outlines(triangles: list[list[int]]) -> list[list[int]] | None:
    """The loops of edges that belong to a single triangle; None when two loops meet in a vertex."""
    edges = {(one, other) for a, b, c in triangles for one, other in ((a, b), (b, c), (c, a))}
    following: dict[int, int] = {}
    for start, end in sorted(edges):
        if (end, start) not in edges:
            if start in following:
                return None
            following[start] = end
    loops = []
    while following:
        start, at = following.popitem()
        loop = [start]
        while at != start:
            loop.append(at)
            at = following.pop(at)
        loops.append(loop)
    return loops


def _area(loop: Array, normal: Array) -> float:
    """Twice the area inside a plane loop (n, 3); negative when it runs clockwise around the normal."""
    centred = loop - loop[0]
    return float(np.cross(centred, np.roll(centred, -1, axis=0)).sum(axis=0) @ normal)


def _vertices_inside_edges(body: Polyhedron, loops: list[list[int]]) -> set[int]:
    """The vertices that lie inside a straight edge between two faces and can be dropped."""
    neighbours: dict[int, set[int]] = {}
    for loop in loops:
        for start, end in zip(loop, [*loop[1:], loop[0]]):
            neighbours.setdefault(start, set()).add(end)
            neighbours.setdefault(end, set()).add(start)
    tolerance = IN_PLANE * np.ptp(body.vertices, axis=0).max()
    found = set()
    for vertex, ends in neighbours.items():
        if len(ends) == 2:
            first, second = (body.vertices[end] - body.vertices[vertex] for end in ends)
            off = np.linalg.norm(np.cross(first, second)) / np.linalg.norm(second - first)
            if off <= tolerance and first @ second < 0:
                found.add(vertex)
    return found
