"""Where a reading crosses its threshold: between two frames, by interpolation, and from where to where its error allows."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise


@dataclass(frozen=True)
class Crossing:
    """A place where a change exceeds the threshold (`rises`) or stops to: places count frames from 1 on, fractions lie between two.
    The errors allow it from `first` to `last`; None if they allow that it is before the first frame, or after the last.
    """

    at: float
    first: float | None
    last: float | None
    rises: bool


def crossings(changes: list[float | None], errors: list[float], threshold: float) -> list[Crossing]:
    """Returns where the size of a change crosses the threshold; changes, errors and threshold in one unit, None for unknown ones.

    Sizes are interpolated by their logarithms, since changes fall like powers of the distance.
    """
    sizes = [None if change is None else abs(change) for change in changes]
    bounds = [
        (None, None) if size is None else (size + error, max(size - error, 0.0))
        for size, error in zip(sizes, errors, strict=True)
    ]
    found = []
    for at, rises in _places(sizes, threshold):
        ends = [_nearest(list(curve), threshold, at, rises) for curve in zip(*bounds, strict=True)]
        first, last = ends if rises else reversed(ends)
        found.append(Crossing(at, first, last, rises))
    return found


def _places(sizes: list[float | None], threshold: float) -> list[tuple[float, bool]]:
    """Returns where sizes cross the threshold, and whether they rise."""
    found = []
    for number, (before, after) in enumerate(pairwise(sizes), start=1):
        if before is not None and after is not None and (before > threshold) != (after > threshold):
            found.append((number + _share(before, after, threshold), after > before))
    return found


def _share(before: float, after: float, threshold: float) -> float:
    """Returns which share of the way from one frame to the next lies before the threshold."""
    if before > 0 and after > 0:
        return math.log(threshold / before) / math.log(after / before)
    return (threshold - before) / (after - before)


def _nearest(curve: list[float | None], threshold: float, at: float, rises: bool) -> float | None:
    """Returns the place nearest to `at` where a curve crosses the threshold in the same direction."""
    same_way = [place for place, direction in _places(curve, threshold) if direction == rises]
    if not same_way:
        return None
    distances = [abs(place - at) for place in same_way]
    return same_way[distances.index(min(distances))]
