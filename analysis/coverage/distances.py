"""From changes at a few distances to the distance from which a probe is noticed, for any threshold."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline, PchipInterpolator

Array = NDArray[np.float64]

FINER = 12
"""Points for each step between two distances, at which the interpolated change is compared with a threshold."""
_LEAST = 1e-30
"""Change (F) that stands for none in logarithms."""


class Curves:
    """Changes over the distance, interpolated in double logarithmic scale: by cubic splines where these stay falling between falling changes, else
    by monotone cubics (Fritsch and Carlson 1980)."""

    def __init__(self, distances: Array, changes: Array) -> None:
        """`changes` (n, distances) in F, NaN from where on a probe cannot be held."""
        count = FINER * (len(distances) - 1) + 1
        logs = np.log(np.maximum(np.abs(changes), _LEAST))
        known = np.isfinite(changes)
        last = known.sum(axis=1)
        logs = _filled(np.log(distances), np.where(known, logs, np.nan), last)
        self._at = np.geomspace(distances[0], distances[-1], count)
        curve = _interpolated(np.log(distances), logs, np.log(self._at))
        reached = np.arange(count) <= FINER * (last[:, None] - 1)
        self._logs: Array = np.where(reached, curve, -np.inf)
        self._is_cut = last < len(distances)
        self._last = self._at[np.clip(FINER * (last - 1), 0, count - 1)]
        self._has_any = last > 0

    def noticed(self, threshold: float) -> tuple[Array, NDArray[np.bool_]]:
        """Returns the distances (n,) up to which everything is noticed, and whether a distance is only the last that was looked at.

        0 is a blind spot: the change is below the threshold at the first distance. NaN: the probe cannot be held there.
        """
        asked = np.log(threshold)
        is_above = self._logs >= asked
        count = len(self._at)
        first = np.where(is_above.all(axis=1), count, is_above.argmin(axis=1))
        rows = np.arange(len(first))
        before, after = np.clip(first - 1, 0, count - 1), np.clip(first, 0, count - 1)
        with np.errstate(invalid="ignore", divide="ignore"):
            high, low = self._logs[rows, before], self._logs[rows, after]
            share = np.where(np.isfinite(low) & (high > low), (high - asked) / (high - low), 0.0)
        found = self._at[before] * (self._at[after] / self._at[before]) ** share
        is_last = (first == count) | ((first > 0) & ~np.isfinite(low))
        found = np.where(first == 0, 0.0, np.where(is_last, self._last, found))
        return np.where(self._has_any, found, np.nan), is_last & self._has_any


def _filled(at: Array, logs: Array, last: NDArray[np.int64]) -> Array:
    """Continues each row along the line through its last two known values, which puts no kink between known ones; a row of one value by it, of none by 0."""
    rows = np.arange(len(logs))
    end, before = np.maximum(last - 1, 0), np.maximum(last - 2, 0)
    value = np.nan_to_num(logs[rows, end])
    step = np.where(end > before, at[end] - at[before], 1.0)
    slope = np.where(end > before, (value - np.nan_to_num(logs[rows, before])) / step, 0.0)
    return np.where(np.isfinite(logs), logs, value[:, None] + slope[:, None] * (at - at[end][:, None]))


def _interpolated(at: Array, logs: Array, finer: Array) -> Array:
    """Returns the rows at finer places."""
    curve = np.asarray(PchipInterpolator(at, logs, axis=1)(finer))
    falling = np.flatnonzero((np.diff(logs, axis=1) < 0).all(axis=1))
    if len(falling):
        spline = np.asarray(CubicSpline(at, logs[falling], axis=1)(finer))
        fits = (np.diff(spline, axis=1) < 0).all(axis=1)
        curve[falling[fits]] = spline[fits]
    return curve
