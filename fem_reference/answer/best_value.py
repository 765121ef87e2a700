"""The best single value between proven bounds, extrapolated from two intervals.

As the mesh is refined both bounds approach the true value in a fixed proportion, so that two intervals show where they meet.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fem_reference.answer.convergence import Estimate, estimate
from fem_reference.solve.enclosure import Enclosure
from fem_reference.solve.level import Level

Array = NDArray[np.float64]

LEAST_NARROWING = 1.5
"""Least ratio of two interval widths at which the value is extrapolated; in theory each halving of the edge size gives 2. Below it
one of the two meshes is bad in a place that spoils one bound more than the other, and the middle of the interval is the better value."""
LEAST_FRACTION_OF_WIDTH = 0.35
"""Least stated error of a value between bounds, as a fraction of their distance: NUMERICS.md section 5."""


def best_value(levels: Sequence[Level]) -> Estimate:
    """The Maxwell matrix and its estimated error: from the levels' bounds where there are any, else from the potentials."""
    likely = [level.estimated for level in levels if level.estimated is not None]
    if likely:
        return _consistent(likely)
    bounds = [level.enclosure for level in levels if level.enclosure is not None]
    potentials = [level.maxwell for level in levels]
    if not bounds:
        return estimate(potentials)
    if len(bounds) > 1:
        return _extrapolated_to_zero_width(bounds)
    (only,) = bounds
    return Estimate((only.lower + only.upper) / 2, only.half_width, np.zeros(only.lower.shape, dtype=bool))


def _consistent(likely: Sequence[tuple[Array, Array]]) -> Estimate:
    """The values on the finest mesh, with an error that reaches the intervals which coarser meshes stated."""
    value, error = likely[-1]
    for before, stated in likely[:-1]:
        error = np.maximum(error, np.abs(value - before) - stated)
    return Estimate(value, error, np.zeros(value.shape, dtype=bool))


def _extrapolated_to_zero_width(bounds: Sequence[Enclosure]) -> Estimate:
    """Extrapolate the middles of two intervals, as a linear function of their widths, to width zero.

    Where the widths do not fall by LEAST_NARROWING, the value is the middle of the narrowest interval. The two narrowest intervals
    of each entry are used, so that a mesh that is worse than a coarser one, as happens, does no harm.
    """
    middles = np.array([(interval.lower + interval.upper) / 2 for interval in bounds])
    widths = np.array([interval.upper - interval.lower for interval in bounds])
    narrowest = np.argsort(widths, axis=0)[:2]
    middle, before = np.take_along_axis(middles, narrowest, axis=0)
    width, width_before = np.take_along_axis(widths, narrowest, axis=0)
    narrows = width_before >= LEAST_NARROWING * width
    slope = (before - middle) / np.where(narrows, width_before - width, 1.0)
    step = np.where(narrows, slope * width, 0.0)
    error = np.where(narrows, np.maximum(np.abs(step), LEAST_FRACTION_OF_WIDTH * width), width / 2)
    return Estimate(middle - step, error, narrows)
