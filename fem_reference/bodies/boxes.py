"""Recognises triangle meshes that bound a box, however its faces are cut into triangles.

Such a mesh is treated as a cuboid, whose distances have closed forms and whose planes of symmetry are known.
"""

from __future__ import annotations

import numpy as np

from fem_reference.bodies.shapes import Cuboid
from fem_reference.bodies.polyhedron import SAME_POINT, Polyhedron


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
