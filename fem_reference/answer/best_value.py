"""The best single value between proven bounds: they narrow in proportion, so that where they meet is known early."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_reference.answer.convergence import Estimate, estimate
from fem_reference.solve.enclosure import Enclosure
from fem_reference.solve.level import Level

LEAST_NARROWING = 1.5
"""Width over the next one's, 2 for each halving in theory. Below it one of the two meshes is bad in a place that spoils one bound
more than the other, and the middle is better."""
LEAST_FRACTION_OF_WIDTH = 0.25
"""The error of a value between bounds is never stated below this fraction of their distance: NUMERICS.md section 5."""


def best_value(levels: Sequence[Level]) -> Estimate:
    """The Maxwell matrix and its estimated error, from the levels' bounds as far as there are any."""
    bounds = [level.enclosure for level in levels if level.enclosure is not None]
    potentials = [level.maxwell for level in levels]
    if not bounds:
        return estimate(potentials)
    if len(bounds) > 1:
        return _between(bounds)
    if len(levels) == 1:
        (only,) = bounds
        return Estimate(
            (only.lower + only.upper) / 2, only.half_width, np.zeros(only.lower.shape, dtype=bool)
        )
    # Narrow bounds on the coarsest level: where the potentials do not converge yet, the theory's ratio is taken all the same.
    found = estimate(potentials)
    theory = 2 * potentials[-1] - potentials[-2]
    every = np.ones(theory.shape, dtype=bool)
    return Estimate(np.where(found.extrapolated, found.value, theory), found.error, every)


def _between(bounds: Sequence[Enclosure]) -> Estimate:
    """Where the line through two intervals' middles, over their widths, meets width zero; the narrowest's middle at worst.

    The two narrowest of each entry are taken: a mesh that is worse than a coarser one, as happens, spoils nothing.
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
