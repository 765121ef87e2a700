"""Merges neighbouring triangles in one plane into one face, so that the mesh need not follow the triangles of plane faces.

Triangles that bound a box, however its faces are cut, are recognised. Such a mesh is treated as a cuboid, whose distances have closed forms
and whose planes of symmetry are known.
"""

from __future__ import annotations

import numpy as np

from fem_reference.bodies.polyhedron import FLAT_DEGREES, SAME_POINT, Polyhedron, connected
from fem_reference.bodies.shapes import Cuboid
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
    return connected(len(body.triangles), sides[angle <= FLAT_DEGREES])


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


def cuboid_of(body: Polyhedron) -> Cuboid | None:
    """The cuboid with the same surface, to the tolerance at which vertices are merged; None when there is none.

    The bounding box is taken in the frame of the triangles' normals. Every triangle has to lie in the face of this box to which its
    outward normal points. A closed surface that is a part of the box's surface is all of it.
    """
    if len(body.parts) != 1:
        return None
    corners = body.vertices[body.triangles]
    doubled_areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(doubled_areas, axis=1)
    normals = doubled_areas / size[:, None]
    first = normals[size.argmax()]
    beside = np.abs(normals @ first) < 0.5
    if not beside.any():
        return None
    second = normals[np.where(beside, size, 0).argmax()]
    second = second - (second @ first) * first
    second /= np.linalg.norm(second)
    axes = np.array([first, second, np.cross(first, second)])
    local = body.vertices @ axes.T
    low, high = local.min(axis=0), local.max(axis=0)
    facing = normals @ axes.T
    axis = np.abs(facing).argmax(axis=1)
    outward = facing[np.arange(len(axis)), axis] > 0
    face = np.where(outward, high[axis], low[axis])
    heights = np.take_along_axis(local[body.triangles], axis[:, None, None], axis=2)[..., 0]
    if np.abs(heights - face[:, None]).max() > SAME_POINT * (high - low).max():
        return None
    a, b, c = (high - low) / 2
    return Cuboid(body.name, (low + high) / 2 @ axes, axes, (float(a), float(b), float(c)))
