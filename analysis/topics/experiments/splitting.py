"""Experiment I: the thesis' splitting of triangles against the exact integral, by level and region around the sensor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from analysis.report import page
from analysis.report.plot import Panel, axis, figure, joined, power_axis, series_colour
from analysis.results.commands import COMPARED_METHOD
from analysis.results.set_up import Rectangle, rectangles
from analysis.results.study_results import CaseResult, Results

IN_FRONT, BESIDE_EDGE, AT_CORNER, SEVERAL = "region I", "region II", "region III", "several regions"
REGIONS = (IN_FRONT, BESIDE_EDGE, AT_CORNER, SEVERAL)
_SPLIT = "split:"
# Thesis 6.1: "after splitting up the triangle only four or more times, the difference is negligible".
_NEGLIGIBLE_FROM_LEVEL = 4
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


_EXPLANATION = (
    "Error: (split:N − exact)/exact of the model's capacitance. Regions as seen along the sensor's normal: I in front "
    "of it, II beside an edge, III diagonal to a corner; the thesis has done this in region I, in one set-up."
)


def parts(found: list[Accuracy]) -> list[Markup]:
    """Returns the finding, the plot and its numbers."""
    if not found:
        return [page.paragraph("No case has answers of the model by split:N.")]
    table = page.table_of(
        found,
        ("region", lambda each: each.region),
        ("splits", lambda each: str(each.level)),
        ("set-ups", lambda each: str(len(each.errors))),
        ("median", lambda each: f"{100 * each.median:.3g} %"),
        ("worst", lambda each: f"{100 * each.worst:.3g} %"),
        ("below exact", lambda each: str(sum(error < 0 for error in each.errors))),
    )
    return [
        page.finding(finding(found)),
        page.figures([_figure(found)]),
        page.folded("Show the figures", table),
        page.soft(_EXPLANATION),
    ]


def finding(found: list[Accuracy]) -> str:
    """Tells the error at the thesis' recommended level in every region, and how often splitting gives too little."""
    levels = {each.level for each in found}
    level = _NEGLIGIBLE_FROM_LEVEL if _NEGLIGIBLE_FROM_LEVEL in levels else max(levels)
    regions = [each for each in found if each.level == level]
    phrases = ", ".join(
        f"{each.region} {100 * each.median:.2g} % ({100 * each.worst:.2g} %)" for each in regions
    )
    errors = [error for each in found for error in each.errors]
    low = sum(error < 0 for error in errors) / len(errors)
    return (
        f"After {level} splits (the thesis: negligible from {_NEGLIGIBLE_FROM_LEVEL} on) the median error, and in brackets the worst, is: {phrases}; "
        f"splitting is below the exact integral in {100 * low:.0f} % of all set-ups and levels."
    )


def _figure(found: list[Accuracy]) -> Panel:
    """Plots the median and the worst error over the level, with a colour for each region."""
    traces: list[object] = []
    for index, region in enumerate(REGIONS):
        members = [each for each in found if each.region == region]
        if not members:
            continue
        for name, values, dash in (
            ("median", [each.median for each in members], "solid"),
            ("worst", [each.worst for each in members], "dot"),
        ):
            levels, errors = [each.level for each in members], [100 * value for value in values]
            hover = "%{x} splits: %{y:.3g} %"
            traces.append(joined(f"{region}, {name}", levels, errors, series_colour(index), hover, dash=dash))
    x = axis("how often each triangle is split in four", dtick=1)
    return Panel("over the set-ups of a region", figure(traces, x, power_axis("error of splitting (%)"), 460))
