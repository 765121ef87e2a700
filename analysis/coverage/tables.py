"""The survey as a table, and as a file for ParaView."""

from __future__ import annotations

import csv
import io
import os
from pathlib import Path

import meshio
import numpy as np
from numpy.typing import NDArray

from analysis.coverage.distances import Curves
from analysis.coverage.survey import Survey
from analysis.results.store import write_text
from geometries.common.children import temporary_folder

Array = NDArray[np.float64]

ANY = "any"
COLUMNS = (
    "place",
    "on",
    "x_m",
    "y_m",
    "z_m",
    "normal_x",
    "normal_y",
    "normal_z",
    "probe",
    "reading",
    "threshold_F",
    "distance_m",
    "kind",
)
"""`kind`: "noticed", up to this distance; "blind", not even at the nearest one; "at least", the farthest at which the probe was held; "blocked", the
probe cannot be held there."""


def distances(
    survey: Survey, probe: int, reading: int | None, factor: float = 1.0
) -> tuple[Array, NDArray[np.str_]]:
    """Returns the distances (m) up to which a probe is noticed at all places, for thresholds times a factor, and their kinds."""
    found, is_last = Curves(survey.distances, survey.ratios(probe, reading)).noticed(factor)
    kinds = np.where(
        np.isnan(found), "blocked", np.where(found == 0, "blind", np.where(is_last, "at least", "noticed"))
    )
    return found, kinds


def write_csv(survey: Survey, path: Path) -> None:
    """Writes a row for each place, probe and reading, and for any of them."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(COLUMNS)
    names: list[tuple[str, int | None]] = [(reading.name, k) for k, reading in enumerate(survey.readings)]
    for p, probe in enumerate(survey.probes):
        for name, k in [*names, (ANY, None)]:
            found, kinds = distances(survey, p, k)
            threshold = "" if k is None else f"{survey.thresholds[k]:.6g}"
            for at, (point, normal) in enumerate(zip(survey.places.points, survey.places.normals)):
                place = (at + 1, survey.places.owners[at], *(f"{x:.5f}" for x in (*point, *normal)))
                distance = "" if np.isnan(found[at]) else f"{found[at]:.5f}"
                rows.writerow((*place, probe.name, name, threshold, distance, kinds[at]))
    write_text(path, text.getvalue())


def write_vtu(survey: Survey, path: Path) -> None:
    """Writes the places as points with their distances by probe, of any reading and of each; NaN where the probe cannot be held."""
    data: dict[str, Array] = {"normal": survey.places.normals}
    for p, probe in enumerate(survey.probes):
        data[f"{probe.name} any"] = distances(survey, p, None)[0]
        for k, reading in enumerate(survey.readings):
            data[f"{probe.name} {reading.name}"] = distances(survey, p, k)[0]
    count = len(survey.places.points)
    cells = [("vertex", np.arange(count).reshape(-1, 1))]
    path.parent.mkdir(parents=True, exist_ok=True)
    with temporary_folder(path.parent) as folder:
        whole = folder / "whole.vtu"
        meshio.write(whole, meshio.Mesh(survey.places.points, cells, point_data=data))
        os.replace(whole, path)
