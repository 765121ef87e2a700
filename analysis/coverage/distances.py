"""From changes at a few distances to the distance from which a probe is noticed, for any threshold; as a table, and as a file for ParaView."""

from pathlib import Path

import meshio
import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline, PchipInterpolator

from analysis.coverage.survey import Survey, over_thresholds
from analysis.results.store import csv_text, write_text
from geometries.common.arrays import Array, Flags, Indices
from geometries.common.files import whole_file

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

    def noticed(self, threshold: float) -> tuple[Array, Flags]:
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


def _filled(at: Array, logs: Array, last: Indices) -> Array:
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


ANY = "any"
_PLACE = ("place", "on", "x_m", "y_m", "z_m", "normal_x", "normal_y", "normal_z")
COLUMNS = (*_PLACE, "probe", "reading", "threshold_F", "distance_m", "kind")
"""`kind`: "noticed", up to this distance; "blind", not even at the nearest one; "at least", the farthest at which the probe was held; "blocked", the
probe cannot be held there."""


def distances(
    survey: Survey, probe: int, reading: int | None = None, factor: float = 1.0
) -> tuple[Array, NDArray[np.str_]]:
    """Returns the distances (m) up to which a probe is noticed at all places, by one reading or any, for thresholds times a factor, and their
    kinds."""
    ratios = over_thresholds(survey.changes[probe], survey.thresholds, reading)
    found, is_last = Curves(survey.distances, ratios).noticed(factor)
    kinds = np.select([np.isnan(found), found == 0, is_last], ["blocked", "blind", "at least"], "noticed")
    return found, kinds


def write_csv(survey: Survey, path: Path) -> None:
    """Writes a row for each place, probe and reading, and for any of them."""
    rows: list[tuple[object, ...]] = []
    names: list[tuple[str, int | None]] = [(reading.name, k) for k, reading in enumerate(survey.readings)]
    for p, probe in enumerate(survey.probes):
        for name, k in [*names, (ANY, None)]:
            found, kinds = distances(survey, p, k)
            threshold = "" if k is None else f"{survey.thresholds[k]:.6g}"
            for at, (point, normal) in enumerate(zip(survey.places.points, survey.places.normals)):
                place = (at + 1, survey.places.owners[at], *(f"{x:.5f}" for x in (*point, *normal)))
                distance = "" if np.isnan(found[at]) else f"{found[at]:.5f}"
                rows.append((*place, probe.name, name, threshold, distance, kinds[at]))
    write_text(path, csv_text(COLUMNS, rows))


def write_vtu(survey: Survey, path: Path) -> None:
    """Writes the places as points with their distances by probe, of any reading and of each; NaN where the probe cannot be held."""
    data: dict[str, Array] = {"normal": survey.places.normals}
    for p, probe in enumerate(survey.probes):
        data[f"{probe.name} any"] = distances(survey, p)[0]
        for k, reading in enumerate(survey.readings):
            data[f"{probe.name} {reading.name}"] = distances(survey, p, k)[0]
    count = len(survey.places.points)
    cells = [("vertex", np.arange(count).reshape(-1, 1))]
    path.parent.mkdir(parents=True, exist_ok=True)
    with whole_file(path) as unfinished:
        meshio.write(unfinished, meshio.Mesh(survey.places.points, cells, point_data=data))
