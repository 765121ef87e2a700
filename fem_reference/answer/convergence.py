"""Richardson extrapolation of the values on successive meshes, with an estimate of the error.

When the edge size is halved at a fixed growth, the error is proportional to the edge size: NUMERICS.md section 3. The remaining
error of the finest mesh is then predicted twice, by the last difference and by half of the difference before it. The mean of the
two predictions is added to the finest value, and their distance enters the stated error. Every quantity is treated by itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometries.common.arrays import Array, Flags

LEAST_RATIO = 1.5
"""Least ratio of successive differences at which values count as converging: 2 in theory, and rather more on coarse meshes."""
LEAST_FRACTION = 0.75
"""Least stated error of an extrapolated value, as a fraction of the larger of the two predictions of the remaining error. Each mesh
is generated anew, so the errors scatter: NUMERICS.md section 3."""
LEAST_FRACTION_CHECKED_TWICE = 0.6
"""The same where the difference before those two passed the check of the ratio as well. It is the least fraction that covers
second-order convergence."""
UNCHECKED_SAFETY = 1.5
"""Factor on the error predicted from the last differences where their ratio fails the check."""
LEAST_OF_TWO_LEVELS = 3e-3
"""Least relative error stated for two levels: they may agree by chance to 7e-5 where both are 1e-3 off. NUMERICS.md section 3."""

SHARED_ERROR = 5e-5
"""Relative error that all levels have in common at a growth of 0.4, because the elements away from the edges are never refined. On the square
plate extrapolation ends 1.4e-5 above the true value; the rest is a margin for other shapes. NUMERICS.md section 3."""


@dataclass(frozen=True)
class Estimate:
    """Best values, their absolute errors, and which of the values are extrapolated; three arrays of the same shape."""

    value: Array
    error: Array
    extrapolated: Flags


def estimate(levels: Sequence[Array]) -> Estimate:
    """Estimate each quantity and its error from its values on levels of edge size h, h/2, h/4 …

    One level says nothing about its own error, which is then stated as 100 %. Two levels allow no check of the ratio, so nothing is
    extrapolated. A quantity is not extrapolated either when one of its differences was larger than the one before it: such values
    have not settled, and every difference counts for the error.
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
    has_grown = _has_grown(levels)
    converges = _converges(previous, last) & ~has_grown
    largest = np.where(has_grown, np.maximum(largest, _largest_remaining_error(levels)), largest)
    twice = _converges(levels[-3] - levels[-4], previous) if len(levels) > 3 else unchecked
    fraction = np.where(twice, LEAST_FRACTION_CHECKED_TWICE, LEAST_FRACTION)
    error = np.maximum(fraction * largest, np.abs(last - predicted))
    value = finest + (last + predicted) / 2
    return Estimate(
        np.where(converges, value, finest), np.where(converges, error, UNCHECKED_SAFETY * largest), converges
    )


def _converges(before: Array, after: Array) -> Flags:
    """Whether two successive differences have one sign and a ratio of at least LEAST_RATIO; without a division, since both may be 0."""
    return np.asarray(before * np.sign(after) >= LEAST_RATIO * np.abs(after))


def _has_grown(levels: Sequence[Array]) -> Flags:
    """Whether any difference of successive levels exceeds the one before it by more than the shared error."""
    sizes = np.abs(np.diff(np.array(levels), axis=0))
    return np.asarray((sizes[1:] > sizes[:-1] + SHARED_ERROR * np.abs(levels[-1])).any(axis=0))


def _largest_remaining_error(levels: Sequence[Array]) -> Array:
    """The largest error that any difference of successive levels predicts for the finest one, halved for every level after it."""
    sizes = np.abs(np.diff(np.array(levels), axis=0))
    halvings = np.arange(len(sizes))[::-1].reshape(-1, *np.ones(sizes.ndim - 1, dtype=int))
    return np.asarray((sizes / 2.0**halvings).max(axis=0))
