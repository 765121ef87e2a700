"""The relative errors of the quantities of one mesh, and what every cell adds to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_reference.solve.cell_gaps import BoundedMatrix
from fem_reference.solve.two_sided import TwoSided

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PartsOfErrors:
    """The parts (cells, q) of the cells in q relative errors, and the whole errors (q,)."""

    of_cells: Array
    whole: Array


def parts_of_errors(matrix: BoundedMatrix, shape_error: float, changes: Sequence[TwoSided]) -> PartsOfErrors:
    """The relative errors of the entries M_ij, j ≥ i, row by row, and of the changes.

    The error of an entry is half the width of its interval, ½√(D_ii·D_jj) with D the gap. As a function of D_ii and D_jj it is homogeneous of degree 1,
    so that its derivatives times what a cell adds to them are parts that add up to it. `shape_error` is the relative effect of curved
    surfaces on energies.
    """
    first, second = np.triu_indices(len(matrix.lower))
    value = np.abs(matrix.lower + matrix.upper)[first, second] / 2
    gap, of_cells = np.diag(matrix.upper - matrix.lower), np.diagonal(matrix.gaps, axis1=1, axis2=2)
    ratio = np.sqrt(gap[second] / gap[first])
    parts = (of_cells[:, first] * ratio + of_cells[:, second] / ratio) / 4
    own = np.diag(matrix.upper)
    whole = np.sqrt(gap[first] * gap[second]) / 2 + shape_error * np.sqrt(own[first] * own[second])
    cells = [parts / value, *(change.of_cells / np.abs(change.value) for change in changes)]
    totals = [whole / value, *(change.error / np.abs(change.value) for change in changes)]
    return PartsOfErrors(np.concatenate(cells, axis=1), np.concatenate(totals))
