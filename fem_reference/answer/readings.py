"""The readings of several meshes combined: value, background and change, each with its error and, where proven, its bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fem_reference.answer.convergence import Estimate, estimate
from fem_reference.answer.wrapped import GeometryError
from fem_reference.bodies.conductors import Conductors
from fem_reference.solve.enclosure import Enclosure, contradict, intersection
from fem_reference.solve.level import Level
from fem_reference.solve.two_sided import TwoSided

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Quantity:
    """A number with its error and, where these are proven, its bounds; farads."""

    value: float
    error: float
    lower: float | None = None
    upper: float | None = None

    def within(self, lower: float, upper: float) -> Quantity:
        """The number moved into proven bounds, with an error that reaches no farther than these."""
        value = min(max(self.value, lower), upper)
        return Quantity(value, min(self.error, max(value - lower, upper - value)), lower, upper)


@dataclass(frozen=True)
class ReadingAnswer:
    """A reading: its value, its background without the targets, and their difference."""

    name: str
    value: Quantity
    background: Quantity
    change: Quantity

    @property
    def relative_error_of_value(self) -> float:
        """The error of the value over the value."""
        return self.value.error / abs(self.value.value) if self.value.value else np.inf

    @property
    def relative_error_of_change(self) -> float:
        """The error of the change over the change; 0 if nothing comes and goes."""
        if self.change.error == 0:
            return 0.0
        return self.change.error / abs(self.change.value) if self.change.value else np.inf


def difference_estimate(
    values: Sequence[Array], width: Array | None, from_bounds: TwoSided | None
) -> Estimate:
    """Estimate differences (n,) of two solutions on one mesh: `from_bounds`, those from the bounds of both on the finest mesh, if there are any.

    Else from their values on successive levels. On a single level their error is at most the larger one of the two solutions, if `width`
    (n,), the width of the interval of the one with the targets, stands for both; without it, 100 %.
    """
    found = estimate(values)
    if from_bounds is not None:
        return Estimate(from_bounds.value, from_bounds.error, np.zeros(found.value.shape, dtype=bool))
    if len(values) == 1 and width is not None:
        found = Estimate(found.value, np.asarray(width), found.extrapolated)
    return found


def of_left_out(problem: Conductors, bound: Array) -> Array:
    """Bounds (n,) on what bodies left out change readings by, if they add at most `bound` to each own entry: |ΔM_ij| ≤ √(b_i·b_j)."""
    root = np.sqrt(bound)
    return np.array([root[r.sense] * root[list(r.drive)].sum() for r in problem.readings])


def combined_readings(
    problem: Conductors,
    levels: Sequence[Level],
    maxwell: Estimate,
    relative: float,
    left_out: Array,
    shape: GeometryError | None,
    proven: bool,
) -> tuple[ReadingAnswer, ...]:
    """The readings in the Maxwell matrix `maxwell`, and their changes from the differences on each mesh.

    `relative` is an error that all levels share, as a share of the change, `left_out` (n,) bounds what bodies left out add to own entries,
    and `shape` is what wraps cost. There are bounds only if those of the matrix are `proven`.
    """
    own = [level.readings for level in levels if level.readings is not None]
    if not own:
        return ()
    bounds = [found.value_bounds for found in own if found.value_bounds is not None]
    around = [found.background_bounds for found in own if found.background_bounds is not None]
    width = np.ptp(bounds[-1], axis=1) if bounds else None
    from_bounds = [found.change_from_bounds for found in own if found.change_from_bounds is not None]
    change = difference_estimate(
        [found.change for found in own], width, from_bounds[-1] if from_bounds else None
    )
    missing = of_left_out(problem, left_out)
    if any(problem.is_target):
        error = change.error + relative * np.abs(change.value) + missing
    else:
        error = missing
    change = Estimate(change.value, error, change.extrapolated)
    if shape is not None:
        change = shape.corrected_readings(change)
    answers = []
    for k, reading in enumerate(problem.readings):
        drive = list(reading.drive)
        value = Quantity(
            float(reading.sign * maxwell.value[reading.sense, drive].sum()),
            float(maxwell.error[reading.sense, drive].sum()),
        )
        if bounds and proven:
            value = value.within(*_intersection(bounds, k, missing[k]))
        changed = Quantity(float(change.value[k]), float(change.error[k]))
        background = Quantity(value.value - changed.value, value.error + changed.error)
        if around and proven:
            low, high = _intersection(around, k, missing[k])
            assert value.lower is not None and value.upper is not None
            changed = changed.within(value.lower - high, value.upper - low)
            background = background.within(low, high)
            # The interval of the change holds this difference too.
            moved = value.value - background.value
            reach = changed.error + abs(moved - changed.value)
            changed = replace(changed, value=moved, error=reach).within(value.lower - high, value.upper - low)
        answers.append(ReadingAnswer(reading.name, value, background, changed))
    return tuple(answers)


def _intersection(bounds: Sequence[Array], k: int, widening: float) -> tuple[float, float]:
    """The intersection of the levels' intervals of one reading, widened for the bodies left out."""
    common = intersection([Enclosure(level[k, 0], level[k, 1]) for level in bounds])
    return float(common.lower) - widening, float(common.upper) + widening


def readings_contradict(levels: Sequence[Level]) -> bool:
    """Whether some reading, or background, has intervals on two levels that have nothing in common."""
    own = [level.readings for level in levels if level.readings is not None]
    bounds = [found.value_bounds for found in own if found.value_bounds is not None]
    around = [found.background_bounds for found in own if found.background_bounds is not None]
    return any(
        len(intervals) > 1 and contradict([Enclosure(each[:, 0], each[:, 1]) for each in intervals])
        for intervals in (bounds, around)
    )
