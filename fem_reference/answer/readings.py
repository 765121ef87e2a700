"""The readings of several meshes combined: value, background and change, each with its error and, where proven, its bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem_reference.answer.convergence import Estimate, estimate
from fem_reference.answer.shared_errors import SharedErrors, corrected
from fem_reference.bodies.conductors import Conductors
from fem_reference.solve.enclosure import Enclosure, contradict, intersection
from fem_reference.solve.level import Level
from fem_reference.solve.readings import LevelReadings
from fem_reference.solve.two_sided import TwoSided
from geometries.common.arrays import Array


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


def delta_self(levels: Sequence[Level], shared: SharedErrors) -> Estimate:
    """The sensors' own entries less those without the objects (m,)."""
    first = levels[0].enclosure
    sensors = len(levels[0].delta_self)
    width = None if first is None else 2 * np.diag(first.half_width)[:sensors]
    known = [level.bounds.delta_self for level in levels if level.bounds is not None]
    found = _difference([level.delta_self for level in levels], width, known)
    error = found.error + shared.relative[:sensors] * np.abs(found.value) + shared.left_out[:sensors]
    found = Estimate(found.value, error, found.extrapolated)
    return found if shared.shape is None else corrected(found, shared.shape.growth_of_change)


def combined_readings(
    problem: Conductors, levels: Sequence[Level], maxwell: Estimate, shared: SharedErrors, proven: bool
) -> tuple[ReadingAnswer, ...]:
    """The readings in the Maxwell matrix `maxwell`, and their changes from the differences on each mesh; only `proven` bounds are told."""
    own = [level.readings for level in levels if level.readings is not None]
    if not own:
        return ()
    bounds, around = _bounds(own)
    change = _changes(problem, own, shared)
    missing = shared.of_readings(problem)
    answers = []
    for k, reading in enumerate(problem.readings):
        drive = list(reading.drive)
        value = Quantity(
            float(reading.sign * maxwell.value[reading.sense, drive].sum()),
            float(maxwell.error[reading.sense, drive].sum()),
        )
        changed = Quantity(float(change.value[k]), float(change.error[k]))
        interval = _intersection(bounds, k, missing[k]) if bounds and proven else None
        if interval is not None:
            value = value.within(*interval)
        background = Quantity(value.value - changed.value, value.error + changed.error)
        if interval is not None and around:
            low, high = _intersection(around, k, missing[k])
            least, most = interval[0] - high, interval[1] - low
            background, changed = background.within(low, high), changed.within(least, most)
            # The interval of the change holds this difference too.
            moved = value.value - background.value
            changed = Quantity(moved, changed.error + abs(moved - changed.value)).within(least, most)
        answers.append(ReadingAnswer(reading.name, value, background, changed))
    return tuple(answers)


def _changes(problem: Conductors, own: Sequence[LevelReadings], shared: SharedErrors) -> Estimate:
    """The changes (k,) of the readings."""
    bounds, _ = _bounds(own)
    width = np.ptp(bounds[-1], axis=1) if bounds else None
    known = [found.change_from_bounds for found in own]
    change = _difference([found.change for found in own], width, known)
    error = shared.of_readings(problem)
    if any(problem.is_target):
        error = change.error + float(shared.relative.max()) * np.abs(change.value) + error
    change = Estimate(change.value, error, change.extrapolated)
    growth = None if shared.shape is None else shared.shape.growth_of_readings
    return change if growth is None else corrected(change, growth)


def _difference(
    values: Sequence[Array], width: Array | None, from_bounds: Sequence[TwoSided | None]
) -> Estimate:
    """Differences (n,) of two solutions on one mesh: those from the bounds of both, on the finest mesh that has them.

    Else from their values on successive levels. On a single level their error is at most the larger one of the two solutions, if `width`
    (n,), the width of the interval of the one with the targets, stands for both; without it, 100 %.
    """
    known = [each for each in from_bounds if each is not None]
    found = estimate(values)
    if known:
        return Estimate(known[-1].value, known[-1].error, np.zeros(found.value.shape, dtype=bool))
    if len(values) == 1 and width is not None:
        found = Estimate(found.value, np.asarray(width), found.extrapolated)
    return found


def _bounds(own: Sequence[LevelReadings]) -> tuple[list[Array], list[Array]]:
    """The levels' bounds of the readings, and of their backgrounds, where there are any."""
    return (
        [found.value_bounds for found in own if found.value_bounds is not None],
        [found.background_bounds for found in own if found.background_bounds is not None],
    )


def _intersection(bounds: Sequence[Array], k: int, widening: float) -> tuple[float, float]:
    """The intersection of the levels' intervals of one reading, widened for the bodies left out."""
    common = intersection([Enclosure(level[k, 0], level[k, 1]) for level in bounds])
    return float(common.lower) - widening, float(common.upper) + widening


def readings_contradict(levels: Sequence[Level]) -> bool:
    """Whether some reading, or background, has intervals on two levels that have nothing in common."""
    return any(
        len(intervals) > 1 and contradict([Enclosure(each[:, 0], each[:, 1]) for each in intervals])
        for intervals in _bounds([level.readings for level in levels if level.readings is not None])
    )
