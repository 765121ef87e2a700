"""Curved surfaces: the second-order cells on them, of which those with inverted maps are mended, and how far faces are from the surfaces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import dolfinx
import numpy as np
from dolfinx.cpp.common import IndexMap
from mpi4py import MPI

from fem_reference.bodies.round_bodies import ROUND_BODIES
from fem_reference.bodies.shapes import Body, Disc
from fem_reference.mesh.body_distances import distance_from_surface, edge_distance
from fem_reference.mesh.distributed import summed
from fem_reference.mesh.quarter_points import (
    ALONG_EDGE,
    CORNERS,
    FACES,
    TETRAHEDRON_EDGES,
    map_derivatives,
    second_order,
    simplex_rule,
    straighten,
)
from geometries.common.arrays import Array, Flags, Integers

SECOND_ORDER_NODES = np.concatenate([CORNERS, CORNERS[TETRAHEDRON_EDGES].mean(axis=1)])
"""The ten nodes of the reference tetrahedron."""

MOST_STRAIGHTENINGS = 20
"""Largest number of passes of `straighten_inverted`; two or three suffice."""
FACE_DEGREE = 8
"""Degree of the quadrature on a face; its points are those at which distances are measured."""
ON_SURFACE = 1e-6
"""Largest distance of a corner on a surface, over the size of the body."""


def curved_cells(nodes: Array, cells: Integers, centre: Array, radius: float) -> Flags:
    """Which cells (n,) have bent sides, except those at the outer sphere (centre, radius)."""
    straight = nodes[cells[:, TETRAHEDRON_EDGES]].mean(axis=2)
    bent = np.linalg.norm(nodes[cells[:, 4:]] - straight, axis=2).max(axis=1)
    length = np.linalg.norm(nodes[cells[:, 1]] - nodes[cells[:, 0]], axis=1)
    inside = np.linalg.norm(nodes[cells[:, 0]] - centre, axis=1) < 0.5 * radius
    return np.asarray((bent > 1e-9 * length) & inside)


def straighten_inverted(nodes: Array, cells: Integers, shared: IndexMap, comm: MPI.Intracomm) -> None:
    """Straighten the cells whose map is inverted (its determinant changes sign) at one of their ten nodes, in place.

    Slivers on a curved surface sometimes have such maps. Straightening a cell moves nodes that its neighbours share, also on other processes
    (`shared` maps the nodes), hence the repetition; a cell with only straight sides is not inverted. Raises RuntimeError when inverted cells remain.
    """
    for _ in range(MOST_STRAIGHTENINGS):
        volumes = np.linalg.det(map_derivatives(nodes[cells], SECOND_ORDER_NODES))
        straight = np.linalg.det(nodes[cells[:, 1:4]] - nodes[cells[:, :1]])
        inverted = cells[(volumes * np.sign(straight)[:, None]).min(axis=1) <= 0]
        remaining = comm.allreduce(len(inverted))
        if not remaining:
            return
        straighten(nodes, inverted)
        moved = np.zeros((len(nodes), 4))
        moved[inverted[:, 4:]] = 1
        moved[:, 1:] *= nodes
        moved = summed(shared, moved)
        anywhere = moved[:, 0] > 0
        nodes[anywhere] = moved[anywhere, 1:] / moved[anywhere, :1]
    raise RuntimeError(f"meshing failed: {remaining} tetrahedra on a curved surface are turned inside out")


@dataclass(frozen=True)
class CurvedFaces:
    """Faces on the surfaces of round bodies, each from every side on which this process owns the cell."""

    cells: Integers
    """(n,): the numbers of these cells."""
    others: Integers
    """(n,): those of the cells on the other side."""
    sides: Integers
    """(n,): the position of each face in its cell."""
    deviations: Array
    """(n, p): the distances of the points of `face_rule` from the surface."""


@cache
def face_rule(side: int) -> tuple[Array, Array]:
    """Points (p, 3) on a face of the reference tetrahedron, and weights (p,) of the integral over a triangle of area 1/2."""
    barycentric, weights = simplex_rule(3, FACE_DEGREE)
    return np.asarray(barycentric @ CORNERS[FACES[side]]), weights


def curved_faces(
    mesh: dolfinx.mesh.Mesh, tags: dolfinx.mesh.MeshTagsMetaClass, bodies: Sequence[Body]
) -> CurvedFaces:
    """Find the faces between cells with different tags whose corners are on the surface of one of the round bodies."""
    round_bodies = [body for body in bodies if isinstance(body, ROUND_BODIES)]
    if not round_bodies:
        none = np.zeros(0, dtype=np.int32)
        return CurvedFaces(none, none, none, np.zeros((0, len(face_rule(0)[1]))))
    topology = mesh.topology
    for pair in ((3, 2), (2, 3)):
        topology.create_connectivity(*pair)
    owned = topology.index_map(3).size_local
    tag = np.zeros(owned + topology.index_map(3).num_ghosts, dtype=np.int32)
    tag[tags.indices] = tags.values
    faces_of = topology.connectivity(3, 2).array.reshape(len(tag), 4)
    to_cells = topology.connectivity(2, 3)
    inner = np.flatnonzero(np.diff(to_cells.offsets) == 2)
    pairs = to_cells.array[to_cells.offsets[inner][:, None] + np.arange(2)]
    between = tag[pairs[:, 0]] != tag[pairs[:, 1]]
    inner, pairs = inner[between], pairs[between]
    faces, cells, others = np.tile(inner, 2), pairs.T.ravel(), pairs[:, ::-1].T.ravel()
    own = cells < owned
    faces, cells, others = faces[own], cells[own], others[own]
    sides = np.argmax(faces_of[cells] == faces[:, None], axis=1).astype(np.int32)
    nodes = mesh.geometry.x[mesh.geometry.dofmap.array.reshape(len(tag), -1)[cells]]
    corners = nodes[np.arange(len(cells))[:, None], FACES[sides]]
    points = _points(nodes, sides)
    deviations = np.full(points.shape[:2], -1.0)
    for body in round_bodies:
        away = distance_from_surface(body, corners.reshape(-1, 3).T).reshape(-1, 3).max(axis=1)
        chosen = (away < ON_SURFACE * body.size) & (deviations[:, 0] < 0)
        found = distance_from_surface(body, points[chosen].reshape(-1, 3).T)
        deviations[chosen] = found.reshape(-1, points.shape[1])
    known = deviations[:, 0] >= 0
    return CurvedFaces(cells[known], others[known], sides[known], deviations[known])


def _points(nodes: Array, sides: Integers) -> Array:
    """The points (n, p, 3) of `face_rule` on faces of second-order cells (n, 10, 3)."""
    found = np.empty((len(nodes), len(face_rule(0)[1]), 3))
    for side in range(len(FACES)):
        own = sides == side
        shapes = second_order().tabulate(0, face_rule(side)[0])[0, :, :, 0]
        found[own] = np.einsum("pk,cki->cpi", shapes, nodes[own])
    return found


def rim_errors(bodies: Sequence[Body], nodes: Array, cells: Integers) -> tuple[Array, Array]:
    """Estimate for each side along the rim of a disc the relative error (n,) of capacitances if the whole rim were as far off; also the sides'
    lengths (n,).

    Moving the rim by d changes the capacitances by d/R of themselves, and by d over the gap to another conductor, which is at least as wide as
    the cells there are long (`sizing`). The estimate is twice the sum.
    """
    errors, lengths = [np.zeros(0)], [np.zeros(0)]
    ends = nodes[cells[:, TETRAHEDRON_EDGES]]
    for disc in bodies:
        if not isinstance(disc, Disc):
            continue
        length = np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=2)
        at_ends = np.asarray(edge_distance(disc, ends.reshape(-1, 3).T)).reshape(ends.shape[:3]).max(axis=2)
        halfway = np.asarray(edge_distance(disc, ends.mean(axis=2).reshape(-1, 3).T)).reshape(length.shape)
        along = (at_ends < ON_SURFACE * disc.size) & (halfway < ALONG_EDGE * length)
        first, last, middle = ends[along][:, 0], ends[along][:, 1], nodes[cells[:, 4:]][along]
        away = [
            edge_distance(
                disc, ((1 - t) * (1 - 2 * t) * first + t * (2 * t - 1) * last + 4 * t * (1 - t) * middle).T
            )
            for t in (0.25, 0.5, 0.75)
        ]
        off = np.max(np.array(away).reshape(3, -1), axis=0)
        errors.append(2 * off * (1 / disc.radius + 1 / length[along]))
        lengths.append(length[along])
    return np.concatenate(errors), np.concatenate(lengths)
