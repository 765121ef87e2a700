"""Where in the gap between both bounds of a mesh the true value lies: by which share of a cell's gap the upper bound exceeds it.

The share depends on the kind of singularity in the cell, and hardly on the mesh, so that both bounds of one mesh give a value far closer than
their distance, and an error for it: NUMERICS.md section 3 has the measurements. The error is estimated, not proven.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem_reference.bodies.shapes import Body, Disc
from fem_reference.mesh.distributed import gathered
from fem_reference.mesh.edges import on_edges
from fem_reference.mesh.tagged_mesh import TaggedMesh
from fem_reference.solve.cell_gaps import BoundedMatrix
from geometries.common.arrays import Array


SHEET_EDGES, ROUND_SHEET_EDGES, SOLID_EDGES, ELSEWHERE = 0, 1, 2, 3
"""Kinds of cells: quarter-point cells at straight edges of plates and at those of discs, cells that touch an edge of a solid body, and all
others."""
OF_UPPER = (0.19, 0.20, 0.36, 0.03)
"""By which share of the gap the upper bound exceeds the true value in cells of each kind, with fluxes of degree 2."""
ERROR = (0.12, 0.18, 0.18, 0.08)
"""Stated error of the value that these shares give, as a share of the gap; the sizes of the cells' parts add up."""


@dataclass(frozen=True)
class Shares:
    """The shares (cells + 1,) of the gaps of the cells and of that outside of the mesh."""

    of_upper: Array
    """By which the upper bound is too high."""
    error: Array
    """By which the true value may differ from what `of_upper` says."""


def equal_shares(cells: int, of_upper: float, error: float) -> Shares:
    """The same shares everywhere."""
    return Shares(np.full(cells + 1, of_upper), np.full(cells + 1, error))


def shares_by_kind(mesh: TaggedMesh, bodies: Sequence[Body]) -> Shares:
    """The shares for fluxes of degree 2, by the kinds of the cells."""
    nodes, corners = mesh.corners()
    at_sheet = gathered(mesh.mesh.comm, mesh.on_edge[: mesh.owned_cells])
    kind = np.full(len(corners) + 1, ELSEWHERE)
    solids = [body for body in bodies if body.is_solid]
    discs = [body for body in bodies if isinstance(body, Disc)]
    used = np.unique(corners)
    at_solid = on_edges(solids, nodes, used)[corners]
    at_disc = on_edges(discs, nodes, used)[corners]
    kind[:-1][at_solid.any(axis=1)] = SOLID_EDGES
    kind[:-1][at_sheet.any(axis=1)] = SHEET_EDGES
    kind[:-1][at_disc.any(axis=1)] = ROUND_SHEET_EDGES
    return Shares(np.array(OF_UPPER)[kind], np.array(ERROR)[kind])


@dataclass(frozen=True)
class Estimated:
    """A matrix (n, n) between both bounds of one mesh, with an error for each entry and the parts (cells, n, n) of the cells in it."""

    value: Array
    error: Array
    of_cells: Array


def estimated(matrix: BoundedMatrix, shares: Shares) -> Estimated:
    """The most likely Maxwell matrix between its bounds."""
    outside = matrix.upper - matrix.lower - matrix.gaps.sum(axis=0)
    high = np.tensordot(shares.of_upper[:-1], matrix.gaps, axes=1) + shares.of_upper[-1] * outside
    of_cells = shares.error[:-1, None, None] * np.abs(matrix.gaps) + np.abs(matrix.shift)
    return Estimated(matrix.upper - high, of_cells.sum(axis=0) + shares.error[-1] * np.abs(outside), of_cells)
