"""The section of an experiment in the report of its study."""

from __future__ import annotations

from markupsafe import Markup

from analysis.report import page
from analysis.results.study_results import Results
from analysis.topics.experiments import (
    materials,
    measured_section,
    neighbours,
    plots,
    splitting,
    words,
)
from analysis.topics.experiments.curves import ANGLE, DISTANCE, Curve, curves, with_flat_start

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
        parts.append(page.paragraph(measured_section.NOTHING_MEASURED))
    elif results.experiment == "V":
        parts = neighbours.parts(neighbours.series(results))
    elif results.experiment == "VI":
        parts = materials.parts(results)
    else:
        parts = _over_distance_or_angle(results.experiment, curves(results))
    return page.section(_TITLES[results.experiment], *parts)


def _over_distance_or_angle(experiment: str, found: list[Curve]) -> list[Markup]:
    """Returns the parts for each sensor: its plates over distance, or its pivoted ones over angle."""
    groups: dict[tuple[float, float], list[Curve]] = {}
    for curve in found:
        groups.setdefault(curve.sensor_size, []).append(curve)
    parts = [measured_section.measured(experiment)]
    parts += [] if groups else [page.paragraph("No curve has both answers.")]
    for size, members in groups.items():
        parts += [page.heading(f"Sensor of {words.size(size)}"), *_of_sensor(experiment, members)]
    return [*parts, page.soft(_DELTA)]


def _of_sensor(experiment: str, found: list[Curve]) -> list[Markup]:
    flat = [curve for curve in found if curve.family == "parallel"]
    if experiment == "IV":
        pivoted = [curve for curve in found if curve.family == "inclined"]
        starting = [with_flat_start(curve, flat[0]) if flat else curve for curve in pivoted]
        swept = ANGLE
        labelled = [(f"hinge at {words.place(curve.hinge_gap, DISTANCE)}", curve) for curve in starting]
    else:
        swept = DISTANCE
        labelled = [(f"plate of {words.plate(curve)}", curve) for curve in flat]
    if not labelled:
        return [page.paragraph("None of this experiment's curves has both answers.")]
    return [
        page.finding(finding(labelled, swept)),
        page.figures([plots.delta_output(labelled, swept), plots.ratios(labelled, swept)]),
        *measured_section.parts(labelled, swept),
    ]


def finding(labelled: words.Labelled, swept: str) -> str:
    """Tells how far the model's delta output is from the reference's on every curve."""
    ranges = words.ranges(labelled, lambda curve: curve.untuned / curve.reference, swept)
    return f"The model's delta output, over the reference's: {ranges}."
