"""Intervals for the entries of the Maxwell matrix, from upper and lower bounds of the energy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometries.common.arrays import Array


@dataclass(frozen=True)
class Enclosure:
    """Two symmetric matrices (n, n) between whose entries those of the true Maxwell matrix lie."""

    lower: Array
    upper: Array

    @property
    def half_width(self) -> Array:
        return np.asarray((self.upper - self.lower) / 2)


def enclosure(below: Array, above: Array) -> Enclosure:
    """Intervals from VᵀLV ≤ VᵀMV ≤ VᵀUV for all voltages V, with L = `below` and U = `above` (n, n).

    D = U − L is positive semidefinite, so that M[i, j] differs from the middle of U[i, j] and L[i, j] by at most
    ½√(D[i, i]·D[j, j]): this is the Cauchy–Schwarz inequality for the semidefinite forms U − M and M − L. U[i, j] and L[i, j]
    themselves are no bounds off the diagonal. The off-diagonal entries of M are never positive, since the charge induced on a
    grounded conductor has the opposite sign. Raises RuntimeError when a diagonal entry of L exceeds that of U, which is impossible for exact energies.
    """
    gap = np.diag(above) - np.diag(below)
    if np.any(gap < 0):
        raise RuntimeError(
            "the lower bound of an energy exceeds its upper bound: the mesh or the solver is at fault"
        )
    middle = (above + below) / 2
    half = np.sqrt(np.outer(gap, gap)) / 2
    off_diagonal = ~np.eye(len(middle), dtype=bool)
    return Enclosure(middle - half, np.where(off_diagonal, np.minimum(middle + half, 0.0), middle + half))


def widened(interval: Enclosure, relative: float) -> Enclosure:
    """Widen the interval for bodies whose capacitances may differ by `relative` from those enclosed."""
    own = np.diag(interval.upper)
    change = relative * np.sqrt(np.outer(own, own))
    return Enclosure(interval.lower - change, interval.upper + change)


def with_left_out(interval: Enclosure, bound: Array) -> Enclosure:
    """Widen the interval to hold for the scene with the bodies that were left out, which add a positive semidefinite matrix to M.

    They increase the diagonal by at most `bound` (n,), and change any other entry, up or down, by at most √(bound[i]·bound[j]).
    """
    change = np.sqrt(np.outer(bound, bound))
    off_diagonal = ~np.eye(len(bound), dtype=bool)
    upper = interval.upper + change
    return Enclosure(
        np.where(off_diagonal, interval.lower - change, interval.lower),
        np.where(off_diagonal, np.minimum(upper, 0.0), upper),
    )


def intersection(enclosures: Sequence[Enclosure]) -> Enclosure:
    """The entrywise intersection of several enclosures of one matrix; where it is empty, the interval that holds them all.

    Exact bounds of one matrix always have something in common: see `contradict`.
    """
    lower, upper = _common(enclosures)
    empty = lower > upper
    return Enclosure(
        np.where(empty, np.min([each.lower for each in enclosures], axis=0), lower),
        np.where(empty, np.max([each.upper for each in enclosures], axis=0), upper),
    )


def contradict(enclosures: Sequence[Enclosure]) -> bool:
    """Whether some entry has intervals that have nothing in common, so that at least one of them is wrong."""
    lower, upper = _common(enclosures)
    return bool(np.any(lower > upper))


def _common(enclosures: Sequence[Enclosure]) -> tuple[Array, Array]:
    """The largest lower and the smallest upper bound of each entry."""
    return (
        np.max([each.lower for each in enclosures], axis=0),
        np.min([each.upper for each in enclosures], axis=0),
    )
