"""The section of an experiment in the report of its study."""

from __future__ import annotations

from markupsafe import Markup

from analysis.report import page
from analysis.report.plot import Panel, figure, joined, power_axis, series_colour
from analysis.results.study_results import Results
from analysis.topics.experiments import curves, materials, neighbours, splitting
from analysis.topics.experiments.curves import ANGLE, DISTANCE, Curve, with_flat_start
from geometries.common.measured import PICOFARAD

NOTHING_MEASURED = (
    "Measured quantity: none. The thesis compares two evaluations of its own formula, and so does this section; their difference is the same "
    "whether the formula stands for mutual or for the change of a reading."
)
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


def measured(experiment: str) -> Markup:
    """Returns which quantity the thesis measured in Experiment II, III or IV."""
    return page.paragraph(_MEASURED.format(_OF_EXPERIMENT[experiment]))


def measured_parts(labelled: curves.Labelled, swept: str) -> list[Markup]:
    """Returns the ratio of change to mutual, and a figure of both, for curves with their names."""
    return [page.finding(measured_finding(labelled, swept)), page.figures([_both(labelled, swept)])]


def measured_finding(labelled: curves.Labelled, swept: str) -> str:
    """Tells how much of mutual the change is on every curve."""
    ranges = curves.ranges(labelled, lambda curve: curve.change_over_mutual, swept)
    return f"The change of the reading, over mutual: {ranges}."


def _both(labelled: curves.Labelled, swept: str) -> Panel:
    traces = []
    for index, (name, curve) in enumerate(labelled):
        for what, dash in (("change", "solid"), ("mutual", "dot")):
            estimates = [getattr(point, what) for point in curve.points]
            values, bars = (
                [getattr(estimate, part) / PICOFARAD for estimate in estimates] for part in ("value", "error")
            )
            across, colour, hover = (
                curves.across(curve, swept),
                series_colour(index),
                "%{y:.4g} pF<br>%{text}",
            )
            more = {"dash": dash, "text": curve.cases, "customdata": curve.cases}
            traces.append(joined(f"{what}, {name}", across, values, colour, hover, bars, **more))
    y = power_axis("capacitance (pF)")
    return Panel(
        "change of the reading, and mutual, by the reference", figure(traces, curves.axis_of(swept), y, 440)
    )


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
        parts = splitting.parts(splitting.accuracies(results))
        parts.append(page.paragraph(NOTHING_MEASURED))
    elif results.experiment == "V":
        parts = neighbours.parts(neighbours.series(results))
    elif results.experiment == "VI":
        parts = materials.parts(results)
    else:
        parts = _over_distance_or_angle(results.experiment, curves.curves(results))
    return page.section(_TITLES[results.experiment], *parts)


def _over_distance_or_angle(experiment: str, found: list[Curve]) -> list[Markup]:
    """Returns the parts for each sensor: its plates over distance, or its pivoted ones over angle."""
    groups: dict[tuple[float, float], list[Curve]] = {}
    for curve in found:
        groups.setdefault(curve.sensor_size, []).append(curve)
    parts = [measured(experiment)]
    parts += [] if groups else [page.paragraph("No curve has both answers.")]
    for size, members in groups.items():
        parts += [page.heading(f"Sensor of {curves.size(size)}"), *_of_sensor(experiment, members)]
    return [*parts, page.soft(_DELTA)]


def _of_sensor(experiment: str, found: list[Curve]) -> list[Markup]:
    flat = [curve for curve in found if curve.family == "parallel"]
    if experiment == "IV":
        pivoted = [curve for curve in found if curve.family == "inclined"]
        starting = [with_flat_start(curve, flat[0]) if flat else curve for curve in pivoted]
        swept = ANGLE
        labelled = [(f"hinge at {curves.place(curve.hinge_gap, DISTANCE)}", curve) for curve in starting]
    else:
        swept = DISTANCE
        labelled = [(f"plate of {curves.plate(curve)}", curve) for curve in flat]
    if not labelled:
        return [page.paragraph("None of this experiment's curves has both answers.")]
    return [
        page.finding(finding(labelled, swept)),
        page.figures([curves.delta_output(labelled, swept), curves.ratios(labelled, swept)]),
        *measured_parts(labelled, swept),
    ]


def finding(labelled: curves.Labelled, swept: str) -> str:
    """Tells how far the model's delta output is from the reference's on every curve."""
    ranges = curves.ranges(labelled, lambda curve: curve.untuned / curve.reference, swept)
    return f"The model's delta output, over the reference's: {ranges}."
