"""The section of an experiment in the report of its study; the first one: the thesis' splitting of triangles against the exact integral."""

from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from analysis.report import page
from analysis.report.plot import Panel, axis, figure, joined, power_axis, series_colour
from analysis.results.statistics import grouped
from analysis.results.study_results import COMPARED_METHOD, CaseResult, Results
from analysis.results.set_up import Rectangle, rectangles
from analysis.topics.experiments import curves, materials, neighbours

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
_NOTHING_MEASURED = (
    "Measured quantity: none. The thesis compares two evaluations of its own formula, and so does this section; their difference is the same "
    "whether the formula stands for mutual or for the change of a reading."
)


def splitting(found: list[Accuracy]) -> list[Markup]:
    """Returns the finding, the plot and its numbers."""
    if not found:
        return [*map(page.paragraph, ("No case has answers of the model by split:N.", _NOTHING_MEASURED))]
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
        page.finding(splitting_finding(found)),
        page.figures([_figure(found)]),
        page.folded("Show the figures", table),
        page.soft(_EXPLANATION),
        page.paragraph(_NOTHING_MEASURED),
    ]


def splitting_finding(found: list[Accuracy]) -> str:
    """Tells the error at the thesis' recommended level in every region, and how often splitting gives too little."""
    levels = {each.level for each in found}
    level = _NEGLIGIBLE_FROM_LEVEL if _NEGLIGIBLE_FROM_LEVEL in levels else max(levels)
    regions = [each for each in found if each.level == level]
    told = [f"{each.region} {100 * each.median:.2g} % ({100 * each.worst:.2g} %)" for each in regions]
    errors = [error for each in found for error in each.errors]
    low = sum(error < 0 for error in errors) / len(errors)
    return (
        f"After {level} splits (the thesis: negligible from {_NEGLIGIBLE_FROM_LEVEL} on) the median error, and in brackets the worst, is: {', '.join(told)}; "
        f"splitting is below the exact integral in {100 * low:.0f} % of all set-ups and levels."
    )


def _figure(found: list[Accuracy]) -> Panel:
    """Plots the median and the worst error over the level, with a colour for each region."""
    traces: list[object] = []
    for region, members in grouped(found, lambda each: each.region).items():
        colour, hover = series_colour(REGIONS.index(region)), "%{x} splits: %{y:.3g} %"
        levels = [each.level for each in members]
        for name, dash in (("median", "solid"), ("worst", "dot")):
            errors = [100 * getattr(each, name) for each in members]
            traces.append(joined(f"{region}, {name}", levels, errors, colour, hover, dash=dash))
    x = axis("how often each triangle is split in four", dtick=1)
    return Panel("over the set-ups of a region", figure(traces, x, power_axis("error of splitting (%)"), 460))


_MEASURED = (
    "Measured quantity: the thesis' electronics sense the driven sensor through a divider, with the plate and without it. This determines the change of the "
    "sensor's reading, which in empty space is delta_self, and not mutual: that is the charge on the plate, which was connected to no meter. All curves of delta output are "
    "made of the change. {} The thesis does not describe the plate's connection; its chapter 7 calls the objects grounded, as here. What a "
    "machine around the sensor or a floating plate makes of the change: Experiment VII."
)
_OF_EXPERIMENT = {
    "II": "The thesis' tuning absorbs a constant ratio of change to mutual; theirs is not constant.",
    "III": "The thesis' tuning absorbs the ratio of change to mutual of one plate only.",
    "IV": "The ratio of change to mutual depends on the angle, too. The holder of the thesis' plate, a dielectric, is left out.",
}


def _both(labelled: curves.Labelled, swept: str) -> Panel:
    traces = []
    for index, (name, curve) in enumerate(labelled):
        for what, dash in (("change", "solid"), ("mutual", "dot")):
            estimates = [getattr(point, what) for point in curve.points]
            colour, hover = series_colour(index), "%{y:.4g} pF<br>%{text}"
            more = {"dash": dash, "text": curve.cases, "customdata": curve.cases}
            across = curves.across(curve, swept)
            traces.append(curves.estimated(f"{what}, {name}", across, estimates, colour, hover, **more))
    drawn = figure(traces, curves.axis_of(swept), power_axis("capacitance (pF)"), 440)
    return Panel("change of the reading, and mutual, by the reference", drawn)


_TITLES = {
    "I": "Experiment I: splitting against the exact integral",
    "II": "Experiment II: one plate over distance",
    "III": "Experiment III: other plate sizes",
    "IV": "Experiment IV: a pivoted plate",
    "V": "Experiment V: two adjacent sensors",
    "VI": "Experiment VI: the material of the target",
}
_DELTA = (
    "Delta output: the sensor's output without the plate minus that with it. The reference's, with delta_self and the sensor's "
    "own capacitance in the divider, takes the place of the physical sensor's; its error bars are mostly too small to see. The "
    "model's is by the thesis' divider, without the own capacitance, and not tuned. Points name their case."
)


def section(results: Results) -> Markup:
    """Returns the section of a study's experiment; empty if the study is no experiment."""
    if not results.experiment:
        return Markup("")
    if results.experiment == "I":
        parts = splitting(accuracies(results))
    elif results.experiment == "V":
        parts = neighbours.parts(neighbours.series(results))
    elif results.experiment == "VI":
        parts = materials.parts(results)
    else:
        parts = _over_distance_or_angle(results.experiment, curves.curves(results))
    return page.section(_TITLES[results.experiment], *parts)


def _over_distance_or_angle(experiment: str, found: list[curves.Curve]) -> list[Markup]:
    """Returns the parts for each sensor: its plates over distance, or its pivoted ones over angle."""
    groups = grouped(found, lambda curve: curve.size("sensor"))
    parts = [page.paragraph(_MEASURED.format(_OF_EXPERIMENT[experiment]))]
    parts += [] if groups else [page.paragraph("No curve has both answers.")]
    for size, members in groups.items():
        parts += [page.heading(f"Sensor of {curves.size(size)}"), *_of_sensor(experiment, members)]
    return [*parts, page.soft(_DELTA)]


def _of_sensor(experiment: str, found: list[curves.Curve]) -> list[Markup]:
    flat = [curve for curve in found if curve.family == "parallel"]
    if experiment == "IV":
        pivoted = [curve for curve in found if curve.family == "inclined"]
        starting = [curves.with_flat_start(curve, flat[0]) if flat else curve for curve in pivoted]
        swept = curves.ANGLE
        hinges = (curves.place(curve.hinge_gap, curves.DISTANCE) for curve in starting)
        labelled = [(f"hinge at {hinge}", curve) for hinge, curve in zip(hinges, starting)]
    else:
        swept = curves.DISTANCE
        labelled = [(f"plate of {curves.size(curve.size('target'))}", curve) for curve in flat]
    if not labelled:
        return [page.paragraph("None of this experiment's curves has both answers.")]
    over_mutual = curves.ranges(labelled, lambda curve: curve.change_over_mutual, swept)
    return [
        page.finding(finding(labelled, swept)),
        page.figures([curves.delta_outputs(labelled, swept), curves.ratios(labelled, swept)]),
        page.finding(f"The change of the reading, over mutual: {over_mutual}."),
        page.figures([_both(labelled, swept)]),
    ]


def finding(labelled: curves.Labelled, swept: str) -> str:
    """Tells how far the model's delta output is from the reference's on every curve."""
    ranges = curves.ranges(labelled, lambda curve: curve.untuned / curve.reference, swept)
    return f"The model's delta output, over the reference's: {ranges}."
