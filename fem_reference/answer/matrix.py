"""The Maxwell matrix of several meshes: its best value with an error, its interval, and what contradicts them.

As the mesh is refined both bounds approach the true value in a fixed proportion, so that two intervals show where they meet. Estimates are
checked against entries that are equal by symmetry and against bounds of their meshes, which cost little and are independent of the errors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem_reference.answer.convergence import Estimate
from fem_reference.answer.readings import readings_contradict
from fem_reference.answer.shared_errors import SharedErrors, corrected
from fem_reference.bodies.conductors import Conductors
from fem_reference.bodies.symmetry import exchanges
from fem_reference.solve.enclosure import Enclosure, contradict, intersection, with_left_out
from fem_reference.solve.level import Level
from geometries.common.arrays import Array

LEAST_NARROWING = 1.5
"""Least ratio of two interval widths at which the value is extrapolated; in theory each halving of the edge size gives 2. Below it
one of the two meshes is bad in a place that spoils one bound more than the other, and the middle of the interval is the better value."""
LEAST_FRACTION_OF_WIDTH = 0.35
"""Least stated error of a value between bounds, as a fraction of their distance: NUMERICS.md section 5."""


@dataclass(frozen=True)
class Matrix:
    """The Maxwell matrix, its interval, and what contradicts their errors, in words; farads."""

    value: Estimate
    interval: Enclosure | None
    """The interval of each entry; None beside estimates, which wider bounds only check."""
    contradicted: str | None


def combined_matrix(problem: Conductors, levels: Sequence[Level], shared: SharedErrors) -> Matrix:
    """The best value of the levels and the intersection of their intervals, with the errors that all levels share."""
    found = best_value(levels)
    added = np.sqrt(np.outer(shared.left_out, shared.left_out))
    found = Estimate(found.value, found.error + shared.boundary + added, found.extrapolated)
    intervals = [level.bounds.interval for level in levels if level.bounds is not None]
    contradicted = None
    if contradict(intervals) or readings_contradict(levels):
        contradicted = "the bounds of two meshes exclude each other"
    interval = with_left_out(intersection(intervals), shared.left_out)
    if shared.shape is not None:
        interval = shared.shape.widened(interval)
        found = corrected(found, shared.shape.growth)
    if levels[-1].enclosure is None:
        found, deviation = checked(found, _exchanges(problem), interval)
        return Matrix(found, None, "; ".join(filter(None, (contradicted, deviation))) or None)
    value = np.clip(found.value, interval.lower, interval.upper)
    reach = np.maximum(value - interval.lower, interval.upper - value)
    # Where meshes contradict each other, no estimate of theirs is better than the interval that holds both.
    error = np.minimum(found.error, reach) if contradicted is None else reach
    return Matrix(Estimate(value, error, found.extrapolated), interval, contradicted)


def best_value(levels: Sequence[Level]) -> Estimate:
    """The Maxwell matrix and its estimated error, from the levels' bounds."""
    likely = [level.estimated for level in levels if level.estimated is not None]
    if likely:
        return _consistent(likely)
    bounds = [level.enclosure for level in levels if level.enclosure is not None]
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


def checked(
    found: Estimate, exchanged: Sequence[Sequence[int]], bounds: Enclosure | None
) -> tuple[Estimate, str | None]:
    """Widen the errors of an estimate until it passes the checks; returns it with a description of what it contradicted.

    The description is None where every deviation was within the errors stated. Each of `exchanged` is a permutation of the
    conductors that leaves the matrix unchanged. `bounds` are proven.
    """
    value, error = found.value, found.error
    contradicted: list[str] = []
    for exchange in exchanged:
        order = np.ix_(exchange, exchange)
        difference = np.abs(value - value[order])
        if np.any(difference > found.error + found.error[order]):
            contradicted.append("entries that are equal by symmetry differ by more than their errors")
        error = np.maximum(error, difference)
    if bounds is not None:
        outside = np.maximum(np.maximum(bounds.lower - value, value - bounds.upper), 0.0)
        if np.any(outside > found.error):
            contradicted.append("entries are outside of the bounds of a mesh by more than their errors")
        error = np.maximum(error, outside)
    words = "; ".join(dict.fromkeys(contradicted)) or None
    return Estimate(value, error, found.extrapolated), words


def _exchanges(problem: Conductors) -> list[tuple[int, ...]]:
    """The permutations of the rows and columns that leave the matrix unchanged, because a mirror image of the scene is the scene."""
    kinds: list[tuple[str, float]] = [("row", 0.0)] * len(problem.names)
    kinds += [("floating", value) for value in problem.to_ground or [0.0] * len(problem.floating)]
    kinds += [("grounded", 0.0)] * len(problem.grounded)
    kinds += [("dielectric", body.contrast) for body in problem.dielectrics]
    orders = exchanges(problem.bodies, problem.owner, kinds, problem.room)
    return [order[: len(problem.names)] for order in orders]
