"""Values from both bounds of one mesh, of a matrix and of the difference of two, whose errors are estimated, not proven; and what every cell adds
to relative errors.

By which share of a cell's gap the upper bound exceeds the true value depends on the kind of singularity in the cell, and hardly on the mesh,
so that both bounds of one mesh give a value far closer than their distance: NUMERICS.md section 3 has the measurements.

The bounds of two scenes on one mesh have most of their errors in common, at edges that both scenes have. In the difference of the two
upper bounds, and in that of the two lower bounds, these cancel. What does not cancel makes the former too large and the latter too small,
or the other way round, by shares that are about equal, so that their distance shows the error of their mean: NUMERICS.md section 5.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem_reference.bodies.shapes import Body, Disc
from fem_reference.mesh.distributed import gathered
from fem_reference.mesh.quarter_points import on_edges
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


FRACTION_OF_DISTANCE = 0.33
"""Stated error of the mean of the two differences, as a fraction of their distance, the sizes of whose parts in the cells add up. In the
cases of the default study without a machine, on the coarsest mesh, the error was at most 0.16 of it, and 0.07 in the median."""


@dataclass(frozen=True)
class TwoSided:
    """Differences (n,) of two scenes' quantities on one mesh."""

    value: Array
    error: Array
    """Estimated, not proven."""
    of_cells: Array
    """(cells, n): the shares of the cells in the error."""

    def scaled(self, factor: float) -> TwoSided:
        """The differences in another unit."""
        return TwoSided(factor * self.value, factor * self.error, factor * self.of_cells)


def two_sided(
    sensed: Array,
    driven: Array,
    present: BoundedMatrix,
    absent: BoundedMatrix,
    signs: Array | float,
    rim_error: float,
    shares: Shares | None = None,
) -> TwoSided:
    """The differences of aᵀMb in a scene and in that without some bodies, for pairs of voltages a, b, the rows of two arrays (k, n).

    Both scenes are bounded on one mesh. `signs` (k,) multiply the differences; `rim_error` is the relative effect of the rims of discs on
    energies. `shares` tell where in the cells' gaps the true values lie; without them, in the middle.
    """
    low, high = present.lower - absent.lower, present.upper - absent.upper
    gaps = present.gaps - absent.gaps
    parts = len(gaps) + 1
    known = shares or Shares(np.full(parts, 0.5), np.full(parts, FRACTION_OF_DISTANCE))
    outside = high - low - gaps.sum(axis=0)
    too_high = np.tensordot(known.of_upper[:-1], gaps, axes=1) + known.of_upper[-1] * outside
    value = signs * _products(sensed, high - too_high, driven)
    of_cells = known.error[:-1, None] * _sizes(sensed, gaps, driven)
    of_cells += _sizes(sensed, present.shift - absent.shift, driven)
    error = of_cells.sum(axis=0) + known.error[-1] * _sizes(sensed, outside, driven)
    return TwoSided(value, error + rim_error * np.abs(value), of_cells)


def _products(left: Array, forms: Array, right: Array) -> Array:
    """The products aᵀFb (…, k) of the rows of two arrays (k, n), for each of the forms (…, n, n)."""
    return np.asarray(np.einsum("ki,...ij,kj->...k", left, forms, right, optimize=True))


def _sizes(left: Array, forms: Array, right: Array) -> Array:
    """The sizes (…, k) of aᵀFb; they are not small if only the errors of a and of b have no product."""
    mean = np.sqrt(np.abs(_products(left, forms, left) * _products(right, forms, right)))
    return np.maximum(np.abs(_products(left, forms, right)), mean)


def unit_voltages(count: int, conductors: Sequence[Sequence[int]]) -> Array:
    """Voltages (k, count): in each row 1 V on some conductors."""
    voltages = np.zeros((len(conductors), count))
    for row, chosen in zip(voltages, conductors):
        row[list(chosen)] = 1
    return voltages


@dataclass(frozen=True)
class PartsOfErrors:
    """The parts (cells, q) of the cells in q relative errors, and the whole errors (q,)."""

    of_cells: Array
    whole: Array


@dataclass(frozen=True)
class Quantities:
    """The quantities aᵀMb whose errors count, by the voltages a of what is sensed and b of what is driven: the rows of two arrays (q, n)."""

    sensed: Array
    driven: Array


def entries(count: int) -> Quantities:
    """All entries M_ij, j ≥ i, row by row, of a matrix of `count` conductors."""
    first, second = np.triu_indices(count)
    return Quantities(np.eye(count)[first], np.eye(count)[second])


def parts_of_errors(
    matrix: BoundedMatrix, asked: Quantities, rim_error: float, changes: Sequence[TwoSided]
) -> PartsOfErrors:
    """The relative errors of enclosed quantities and of the changes.

    The error of a quantity is half the width of its interval, ½√(aᵀDa·bᵀDb) with D the gap. As a function of aᵀDa and bᵀDb it is homogeneous of degree
    1, so that its derivatives times what a cell adds to them are parts that add up to it. `rim_error` is the relative effect of the rims of
    discs on energies.
    """
    gap, sides = matrix.upper - matrix.lower, (asked.sensed, asked.driven)
    first, second = (_products(side, gap, side) for side in sides)
    at_first, at_second = (_products(side, matrix.gaps, side) for side in sides)
    ratio = np.sqrt(second / first)
    parts = (at_first * ratio + at_second / ratio) / 4
    value = np.abs(_values((matrix.lower + matrix.upper) / 2, asked))
    whole = np.sqrt(first * second) / 2 + rim_error * _energies(matrix.upper, asked)
    return _with_changes(parts / value, whole / value, changes)


def parts_of_estimates(
    found: Estimated, asked: Quantities, rim_error: float, changes: Sequence[TwoSided]
) -> PartsOfErrors:
    """The relative errors of estimated quantities, to which those of all entries in them add up, and of the changes."""
    value = np.abs(_values(found.value, asked))
    parts = _values(found.of_cells, asked)
    whole = _values(found.error, asked) + rim_error * _energies(found.value, asked)
    return _with_changes(parts / value, whole / value, changes)


def _values(matrix: Array, asked: Quantities) -> Array:
    return _products(asked.sensed, matrix, asked.driven)


def _energies(matrix: Array, asked: Quantities) -> Array:
    """The geometric means (q,) of the energies of both sets of voltages."""
    of_sensed, of_driven = (_products(side, matrix, side) for side in (asked.sensed, asked.driven))
    return np.asarray(np.sqrt(of_sensed * of_driven))


def _with_changes(parts: Array, whole: Array, changes: Sequence[TwoSided]) -> PartsOfErrors:
    cells = [parts, *(change.of_cells / np.abs(change.value) for change in changes)]
    totals = [whole, *(change.error / np.abs(change.value) for change in changes)]
    return PartsOfErrors(np.concatenate(cells, axis=1), np.concatenate(totals))
