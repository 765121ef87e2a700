"""Second-order cells on curved surfaces: finds them, estimates the error of their shape, and mends those with inverted maps."""

from __future__ import annotations

import basix
import numpy as np
from dolfinx.cpp.common import IndexMap
from mpi4py import MPI
from numpy.typing import NDArray

from fem_reference.mesh.distributed import summed
from fem_reference.mesh.quarter_points import TETRAHEDRON_EDGES, second_order, straighten

Array = NDArray[np.float64]

VERTICES = np.array(basix.geometry(basix.CellType.tetrahedron))
"""The four vertices of the reference tetrahedron."""
SECOND_ORDER_NODES = np.concatenate([VERTICES, VERTICES[TETRAHEDRON_EDGES].mean(axis=1)])
"""The ten nodes of the reference tetrahedron."""

MOST_STRAIGHTENINGS = 20
"""Largest number of passes of `straighten_inverted`; two or three suffice."""


def curved_cells(nodes: Array, cells: NDArray[np.int32], centre: Array, radius: float) -> NDArray[np.bool_]:
    """Which cells (n,) have bent sides, except those at the outer sphere (centre, radius)."""
    straight = nodes[cells[:, TETRAHEDRON_EDGES]].mean(axis=2)
    bent = np.linalg.norm(nodes[cells[:, 4:]] - straight, axis=2).max(axis=1)
    length = np.linalg.norm(nodes[cells[:, 1]] - nodes[cells[:, 0]], axis=1)
    inside = np.linalg.norm(nodes[cells[:, 0]] - centre, axis=1) < 0.5 * radius
    return np.asarray((bent > 1e-9 * length) & inside)


def shape_errors(nodes: Array, cells: NDArray[np.int32]) -> Array:
    """Estimate for each of the second-order cells (n, 10) the relative error (n,) of capacitances if all cells followed a curved surface as
    nearly as this one.

    A parabola through the ends and the middle of an arc of half angle a and radius R lies up to R·a⁴/32 inside the circle. A
    displacement d of a surface changes the capacitances by at most d/R of themselves, and by d over the gap to another conductor,
    which is at least as wide as the cells there are long (`sizing`). The estimate is the sum of both for the worst side of a cell, doubled
    because a face bends in two directions.
    """
    ends = nodes[cells[:, TETRAHEDRON_EDGES]]
    chord = ends[:, :, 1] - ends[:, :, 0]
    length = np.linalg.norm(chord, axis=2)
    height = np.linalg.norm(nodes[cells[:, 4:]] - ends.mean(axis=2), axis=2)
    half_angle = 2 * np.arctan(2 * height / length)
    deviation = half_angle**4 / 32
    radius_over_length = 1 / np.maximum(2 * np.sin(half_angle), 1e-9)
    return np.asarray(2 * np.max(deviation * (1 + radius_over_length), axis=1))


def areas(nodes: Array, cells: NDArray[np.int32]) -> Array:
    """The sizes (n,) of the faces of cells (n, 10), as the squares of their longest sides."""
    ends = nodes[cells[:, TETRAHEDRON_EDGES]]
    return np.asarray((np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=2) ** 2).max(axis=1))


def straighten_inverted(
    nodes: Array, cells: NDArray[np.int32], shared: IndexMap, comm: MPI.Intracomm
) -> None:
    """Straighten the cells whose map is inverted (its determinant changes sign) at one of their ten nodes, in place.

    Slivers on a curved surface sometimes have such maps. Straightening a cell moves nodes that its neighbours share, also on other processes
    (`shared` maps the nodes), hence the repetition; a cell with only straight sides is not inverted. Raises RuntimeError when inverted cells remain.
    """
    gradients = second_order().tabulate(1, SECOND_ORDER_NODES)[1:, :, :, 0]
    for _ in range(MOST_STRAIGHTENINGS):
        volumes = np.linalg.det(np.einsum("dpn,cni->cpid", gradients, nodes[cells]))
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
