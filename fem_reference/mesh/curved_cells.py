"""Second-order cells on curved surfaces: finds them, and mends those with inverted maps."""

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
