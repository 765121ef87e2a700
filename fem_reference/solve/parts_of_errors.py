"""The relative errors of the quantities of one mesh, and what every cell adds to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem_reference.solve.cell_gaps import BoundedMatrix
from fem_reference.solve.two_sided import Estimated, TwoSided
from geometries.common.arrays import Array


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
    gap = matrix.upper - matrix.lower
    sides = (asked.sensed, asked.driven)
    first, second = (np.einsum("qi,ij,qj->q", side, gap, side) for side in sides)
    at_first, at_second = (
        np.einsum("qi,cij,qj->cq", side, matrix.gaps, side, optimize=True) for side in sides
    )
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
    parts = np.einsum("qi,cij,qj->cq", asked.sensed, found.of_cells, asked.driven, optimize=True)
    whole = _values(found.error, asked) + rim_error * _energies(found.value, asked)
    return _with_changes(parts / value, whole / value, changes)


def _values(matrix: Array, asked: Quantities) -> Array:
    return np.asarray(np.einsum("qi,ij,qj->q", asked.sensed, matrix, asked.driven))


def _energies(matrix: Array, asked: Quantities) -> Array:
    """The geometric means (q,) of the energies of both sets of voltages."""
    of_sensed = _values(matrix, Quantities(asked.sensed, asked.sensed))
    of_driven = _values(matrix, Quantities(asked.driven, asked.driven))
    return np.asarray(np.sqrt(of_sensed * of_driven))


def _with_changes(parts: Array, whole: Array, changes: Sequence[TwoSided]) -> PartsOfErrors:
    cells = [parts, *(change.of_cells / np.abs(change.value) for change in changes)]
    totals = [whole, *(change.error / np.abs(change.value) for change in changes)]
    return PartsOfErrors(np.concatenate(cells, axis=1), np.concatenate(totals))
