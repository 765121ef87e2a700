"""Experiment I: the thesis' splitting of triangles against the exact integral, by level and region around the sensor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analysis.results.set_up import Rectangle, rectangles
from analysis.results.study_results import CaseResult, Results
from analysis.results.commands import COMPARED_METHOD

IN_FRONT, BESIDE_EDGE, AT_CORNER, SEVERAL = "region I", "region II", "region III", "several regions"
REGIONS = (IN_FRONT, BESIDE_EDGE, AT_CORNER, SEVERAL)
_SPLIT = "split:"
# Relative tolerance for the rounding of a plate that ends above the sensor's edge.
_TOLERANCE = 1e-9


@dataclass(frozen=True)
class Accuracy:
    """(split − exact)/exact of the set-ups of a region at one level."""

    region: str
    level: int
    errors: tuple[float, ...]

    @property
    def median(self) -> float:
        return float(np.median(np.abs(self.errors)))

    @property
    def worst(self) -> float:
        return float(np.max(np.abs(self.errors)))


def region(sensor: Rectangle, target: Rectangle) -> str:
    """Returns the thesis' region (5.3) that the target lies in, seen along the sensor's normal."""
    # The edges of a plate are at right angles.
    edges = np.array([edge / (edge @ edge) for edge in (sensor.edge_u, sensor.edge_v)])
    along = edges @ (target.vertices - sensor.corner).T
    low, high = along.min(axis=1), along.max(axis=1)
    within = (low >= -_TOLERANCE) & (high <= 1 + _TOLERANCE)
    beside = (high <= _TOLERANCE) | (low >= 1 - _TOLERANCE)
    if within.all():
        return IN_FRONT
    if beside.all():
        return AT_CORNER
    return BESIDE_EDGE if (within | beside).all() else SEVERAL


def accuracies(results: Results) -> list[Accuracy]:
    """Returns an entry for each region and level that has answers, regions in the thesis' order, levels upwards."""
    found: dict[tuple[str, int], list[float]] = {}
    for case in results.compared():
        plates = rectangles(case.scene)
        if plates is not None:
            for level, error in _errors(case).items():
                found.setdefault((region(*plates), level), []).append(error)
    ordered = sorted(found, key=lambda entry: (REGIONS.index(entry[0]), entry[1]))
    return [Accuracy(name, level, tuple(found[name, level])) for name, level in ordered]


def _errors(case: CaseResult) -> dict[int, float]:
    if case.model is None:
        return {}
    sensor = case.scene.sensors[0].name
    exact = case.model.values[COMPARED_METHOD][sensor].total
    return {
        int(method.removeprefix(_SPLIT)): values[sensor].total / exact - 1
        for method, values in case.model.values.items()
        if method.startswith(_SPLIT) and method.removeprefix(_SPLIT).isdecimal()
    }
