"""Which vertices of a mesh lie on the edges of bodies, and which sides of its cells lie along them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_reference.bodies.polyhedron import Polyhedron
from fem_reference.bodies.shapes import Body
from fem_reference.mesh.body_distances import edge_distance
from fem_reference.mesh.tape import SizeFunction, Tape
from geometries.common.arrays import Array, Flags, Indices, Integers

ON_EDGE = 1e-7
"""Largest distance of a vertex on an edge, over the size of the body."""
ALONG_EDGE = 0.15
"""Largest distance of the middle of a tetrahedron's side from an edge, over the length of the side, if it lies along this edge: a
side along a circular edge is a chord, and one across a right-angled corner is 0.35 of its length away."""


def on_edges(bodies: Sequence[Body], nodes: Array, used: Integers) -> Flags:
    """Which of the nodes (n, 3) lie on an edge of one of the bodies; only those with the numbers `used` are looked at."""
    found = np.zeros(len(nodes), dtype=bool)
    for body in bodies:
        away = _distance_from_edges(body, nodes[used])
        if away is not None:
            found[used] |= away < ON_EDGE * body.size
    return found


def sides_along_edges(bodies: Sequence[Body], nodes: Array, cells: Integers) -> Indices:
    """The sides (n, 2) of tetrahedra that lie along the edges of bodies, by the numbers of their vertices."""
    used = np.unique(cells)
    found = [np.zeros((0, 2), dtype=np.int64)]
    for body in bodies:
        on_edge = on_edges([body], nodes, used)
        if not on_edge.any():
            continue
        pairs = [cells[:, pair] for pair in ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))]
        sides = np.unique(np.sort(np.concatenate([p[on_edge[p].all(axis=1)] for p in pairs]), axis=1), axis=0)
        ends = nodes[sides]
        length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        middle = _distance_from_edges(body, ends.mean(axis=1)) if len(sides) else None
        if middle is not None:
            found.append(sides[middle < ALONG_EDGE * length])
    return np.asarray(np.unique(np.concatenate(found), axis=0), dtype=np.int64)


def _distance_from_edges(body: Body, points: Array) -> Array | None:
    """The distances (n,) of points from the nearest edge of a body; None if it has none."""
    if isinstance(body, Polyhedron):
        edges = body.vertices[body.edges]
        if not len(edges):
            return None
        return SizeFunction(Tape().distance(edges[:, [0, 1, 1]]))(points)
    found = edge_distance(body, points.T)
    return None if found is None else np.asarray(found)
