"""From values on successive meshes to one value and an honest error.

On meshes whose edge size is halved at a fixed growth the error falls like the edge size: NUMERICS.md section 3. What is
left after the finest mesh is then the last difference, and also half the one before. The mean of the two is added, and how far they
are apart is a part of the error, for every quantity by itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LEAST_RATIO = 1.5
"""Of successive differences, 2 in theory and rather more on coarse meshes. Below it the meshes do not converge yet."""
LEAST_FRACTION = 0.75
"""The error of an extrapolated value is never stated below this fraction of the larger of the two predictions of what is left.
Meshes are generated anew, so their errors scatter: NUMERICS.md section 3."""
LEAST_FRACTION_CHECKED_TWICE = 0.6
"""The same where the two differences before fell as they should, too: least at which it covers an order of convergence of two."""
UNCHECKED_SAFETY = 1.5
"""Factor on the error predicted from the last differences where they do not fall as they should."""
LEAST_OF_TWO_LEVELS = 3e-3
"""Relative: the first two meshes may agree by chance to 7e-5 where they are both 1e-3 off. NUMERICS.md section 3."""

SHARED_ERROR = 5e-5
"""Relative error that every level has in common, since away from the edges the elements do not shrink: 1.4e-5 on the
square plate with a growth of SHARED_GROWTH, where extrapolation ends that far above the truth, times a margin for other
shapes. NUMERICS.md section 3."""
SHARED_GROWTH = 0.4
SHARED_ORDER = 6
"""Cubic elements leave an energy error of the sixth power of their size over the distance to the edges: the growth."""


@dataclass(frozen=True)
class Estimate:
    """Best values, absolute errors, and where the value is extrapolated; three arrays of one shape."""

    value: Array
    error: Array
    extrapolated: NDArray[np.bool_]


def estimate(levels: Sequence[Array]) -> Estimate:
    """Best value and error of each quantity from its values on levels of edge size h, h/2, h/4 …

    One level says nothing about its own error, which is then stated as 100 %; two levels allow no check of the ratio,
    so nothing is extrapolated. Nothing is either where a difference was ever larger than the one before it: such values have not
    settled, and the error is what any of the differences may have left.
    """
    finest = levels[-1]
    unchecked = np.zeros(finest.shape, dtype=bool)
    if len(levels) == 1:
        return Estimate(finest, np.abs(finest), unchecked)
    last = finest - levels[-2]
    if len(levels) == 2:
        error = np.maximum(2 * np.abs(last), LEAST_OF_TWO_LEVELS * np.abs(finest))
        return Estimate(finest, error, unchecked)
    previous = levels[-2] - levels[-3]
    predicted, last_size = previous / 2, np.abs(last)
    largest = np.maximum(np.abs(predicted), last_size)
    jumped = _jumped(levels)
    falls = _falls(previous, last) & ~jumped
    largest = np.where(jumped, np.maximum(largest, _left_of_all(levels)), largest)
    twice = _falls(levels[-3] - levels[-4], previous) if len(levels) > 3 else unchecked
    fraction = np.where(twice, LEAST_FRACTION_CHECKED_TWICE, LEAST_FRACTION)
    error = np.maximum(fraction * largest, np.abs(last - predicted))
    value = finest + (last + predicted) / 2
    return Estimate(np.where(falls, value, finest), np.where(falls, error, UNCHECKED_SAFETY * largest), falls)


def _falls(before: Array, after: Array) -> NDArray[np.bool_]:
    """Whether a difference follows one before as it should; not as a quotient, since both may be 0."""
    return np.asarray(before * np.sign(after) >= LEAST_RATIO * np.abs(after))


def _jumped(levels: Sequence[Array]) -> NDArray[np.bool_]:
    """Whether a difference of successive levels was larger than the one before it, by more than what all levels share."""
    sizes = np.abs(np.diff(np.array(levels), axis=0))
    return np.asarray((sizes[1:] > sizes[:-1] + SHARED_ERROR * np.abs(levels[-1])).any(axis=0))


def _left_of_all(levels: Sequence[Array]) -> Array:
    """The most that any of the differences of successive levels leaves on the finest one: half of it for each level since."""
    sizes = np.abs(np.diff(np.array(levels), axis=0))
    halvings = np.arange(len(sizes))[::-1].reshape(-1, *np.ones(sizes.ndim - 1, dtype=int))
    return np.asarray((sizes / 2.0**halvings).max(axis=0))


def shared_error(growth: float) -> float:
    """The relative error that all levels of one growth have in common."""
    return SHARED_ERROR * (growth / SHARED_GROWTH) ** SHARED_ORDER


def open_boundary_error(maxwell: Array, extent: float, radius: float) -> Array:
    """Bound (n, n) on what the open-boundary condition neglects, in the unit of `maxwell` (ε = 1, metres).

    The condition is exact for a charge in the centre; a multipole of order l meets the coefficient 1/R in the place of
    (l + 1)/R. Charges within `extent` of the centre of a sphere of `radius` R, of total size at most 2·maxwell[i, i],
    bound every multipole; derivation in NUMERICS.md section 4.
    """
    q = extent / radius
    orders = np.arange(1, 20)
    series = float(np.sum(orders / (2 * orders + 1) * q ** (2 * orders)))
    own = (2 * np.diag(maxwell)) ** 2 / (4 * np.pi * radius) * series
    return np.asarray(np.sqrt(np.outer(own, own)))
