"""The difference of two quantities on one mesh, from the upper bounds of both and from the lower bounds of both.

The bounds of two scenes on one mesh have most of their errors in common, at edges that both scenes have. In the difference of the two
upper bounds, and in that of the two lower bounds, these cancel. What does not cancel makes the former too large and the latter too small,
or the other way round, by shares that are about equal, so that their distance shows the error of their mean: NUMERICS.md section 5.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem_reference.solve.cell_gaps import BoundedMatrix
from fem_reference.solve.shares import Shares, equal_shares
from geometries.common.arrays import Array

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
    known = shares or equal_shares(len(gaps), 0.5, FRACTION_OF_DISTANCE)
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
