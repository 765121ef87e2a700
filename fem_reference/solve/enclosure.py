"""From energies above and below to an interval for every entry of the Maxwell matrix."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Enclosure:
    """Two symmetric matrices (n, n); every entry of the true one lies between theirs."""

    lower: Array
    upper: Array

    @property
    def half_width(self) -> Array:
        return np.asarray((self.upper - self.lower) / 2)


def enclosure(below: Array, above: Array) -> Enclosure:
    """Intervals from VᵀLV ≤ VᵀMV ≤ VᵀUV for all voltages V, L = `below` and U = `above` (n, n).

    With D = U − L positive semidefinite the distance of M[i, j] from the middle is at most ½√(D[i, i]·D[j, j]) (Cauchy and
    Schwarz for the two semidefinite forms U − M and M − L); U[i, j] and L[i, j] alone bound nothing. Off the diagonal M is
    never positive: the charge that a grounded conductor takes has the other sign. Raises RuntimeError when L exceeds U,
    which no exact energies can.
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
    """The interval for bodies whose capacitances may differ by this much, relatively, from those enclosed."""
    own = np.diag(interval.upper)
    change = relative * np.sqrt(np.outer(own, own))
    return Enclosure(interval.lower - change, interval.upper + change)


def with_left_out(interval: Enclosure, bound: Array) -> Enclosure:
    """The interval for the scene with bodies that were left out: they add a positive semidefinite matrix to M.

    `bound` (n,) is more than they add to the diagonal; of the rest the matrix may add or take √(bound[i]·bound[j]).
    """
    change = np.sqrt(np.outer(bound, bound))
    off_diagonal = ~np.eye(len(bound), dtype=bool)
    upper = interval.upper + change
    return Enclosure(
        np.where(off_diagonal, interval.lower - change, interval.lower),
        np.where(off_diagonal, np.minimum(upper, 0.0), upper),
    )


def intersection(enclosures: Sequence[Enclosure]) -> Enclosure:
    """What several enclosures of one matrix leave."""
    return reduce(
        lambda a, b: Enclosure(np.maximum(a.lower, b.lower), np.minimum(a.upper, b.upper)), enclosures
    )
