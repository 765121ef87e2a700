"""From values on successive meshes to one value and an honest error.

On meshes whose edge size is halved at a fixed growth the error falls like the edge size: NUMERICS.md section 3. The
differences of successive levels then have the ratio 2, and Richardson's extrapolation adds the last difference once
more. The ratio is checked for every quantity by itself; where it is off, nothing is extrapolated and the error grows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

RATIO_RANGE = (1.5, 3.0)
"""Ratios of successive differences taken for the theory's 2: meshes are generated anew, so their errors scatter."""
LEAST_FRACTION = 0.6
"""The error of an extrapolated value is never stated below this fraction of the step of the extrapolation. The largest
fraction found in the verification cases is 0.45: NUMERICS.md section 3."""
UNCHECKED_SAFETY = 1.5
"""Factor on the error predicted from the last differences where their ratio is not the theory's."""

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
    so nothing is extrapolated.
    """
    finest = levels[-1]
    unchecked = np.zeros(finest.shape, dtype=bool)
    if len(levels) == 1:
        return Estimate(finest, np.abs(finest), unchecked)
    last = finest - levels[-2]
    if len(levels) == 2:
        return Estimate(finest, 2 * np.abs(last), unchecked)
    previous = levels[-2] - levels[-3]
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where((last == 0) & (previous == 0), 2.0, previous / last)
        scatter = np.abs(1 - 1 / (ratio - 1))
    checked = (ratio >= RATIO_RANGE[0]) & (ratio <= RATIO_RANGE[1])
    refused = UNCHECKED_SAFETY * np.maximum(np.abs(previous) / 2, np.abs(last))
    error = np.where(checked, np.maximum(scatter, LEAST_FRACTION) * np.abs(last), refused)
    return Estimate(np.where(checked, finest + last, finest), error, checked)


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
