"""The section of an experiment in the report of its study."""

from __future__ import annotations

from markupsafe import Markup

from analysis.report import page
from analysis.results.study_results import Results
from analysis.topics.experiments import (
    materials,
    measured_section,
    neighbours,
    splitting,
    tables,
    tuned_sections,
)
from analysis.topics.experiments.calibration import FORMS, OBSERVABLE, calibrate
from analysis.topics.experiments.curves import Curve, curves, with_flat_start

_TITLES = {
    "I": "Experiment I: splitting against the exact integral",
    "II": "Experiment II: tuning to one plate",
    "III": "Experiment III: other plate sizes",
    "IV": "Experiment IV: a pivoted plate",
    "V": "Experiment V: two adjacent sensors",
    "VI": "Experiment VI: the material of the target",
}
_DELTA = (
    "Delta output: the sensor's output without the plate minus that with it. The reference's, with delta_self and the sensor's "
    "own capacitance in the divider, takes the place of the physical sensor's; its error bars are mostly too small to see. "
    "Tuned with the own capacitance counted, coupling capacitance and ε are free; in the thesis' divider only their ratio "
    "counts, and ε is free at the scene's coupling capacitance. Volts alike: the fit weights all residuals equally, as an eye does "
    "on the plot; by error bars: residuals are weighted by the reference's error bars. Errors of the constants are standard errors with the scatter of the "
    f"residuals. Observable: at least {100 * OBSERVABLE:.0f} % of the greatest delta output of the plate tuned to; the thesis ends "
    "its curves where the plate is hardly so. Its sizes and distances are blacked out. Points name their case."
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
        parts = _tuned(results.experiment, curves(results))
    return page.section(_TITLES[results.experiment], *parts)


def _tuned(experiment: str, found: list[Curve]) -> list[Markup]:
    """Returns the parts for each sensor, calibrated on its first plate over distance."""
    groups: dict[tuple[float, float], list[Curve]] = {}
    for curve in found:
        groups.setdefault(curve.sensor_size, []).append(curve)
    parts = [measured_section.measured(experiment)]
    parts += [] if groups else [page.paragraph("No curve has both answers.")]
    for size, members in groups.items():
        parts += [page.heading(f"Sensor of {tables.size(size)}"), *_of_sensor(experiment, members)]
    return [*parts, page.soft(_DELTA)]


def _of_sensor(experiment: str, found: list[Curve]) -> list[Markup]:
    flat = next((curve for curve in found if curve.family == "parallel"), None)
    if flat is None:
        return [page.paragraph("No curve over distance has both answers, so nothing can be tuned.")]
    try:
        tunings = [calibrate(flat, form) for form in FORMS]
    except ValueError as error:
        return [page.paragraph(f"Not tuned: {error}.")]
    if experiment == "II":
        return tuned_sections.one_plate(flat, tunings)
    if experiment == "III":
        others = [curve for curve in found if curve.family == "parallel" and curve is not flat]
        return tuned_sections.other_sizes(flat, others, tunings)
    pivoted = [with_flat_start(curve, flat) for curve in found if curve.family == "inclined"]
    return tuned_sections.pivoted_plates(flat, pivoted, tunings)
