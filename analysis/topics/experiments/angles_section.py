"""Experiment IV in the report: a plate pivoted about one edge, predicted by the model calibrated on the parallel plate."""

from __future__ import annotations

from markupsafe import Markup

from analysis.report import page
from analysis.results.units import signed_percent
from analysis.topics.experiments import measured_section, plots, tables
from analysis.topics.experiments.calibration import OWN, Calibration, deviation, summary
from analysis.topics.experiments.curves import ANGLE, DISTANCE, Curve


def parts(flat: Curve, pivoted: list[Curve], tunings: list[Calibration]) -> list[Markup]:
    """Returns the finding, the curves over angle, the deviations, and every calibration with its constants."""
    own = next(tuned for tuned in tunings if tuned.form == OWN)
    labelled = [(f"hinge at {tables.place(curve.hinge_gap, DISTANCE)}", curve) for curve in pivoted]
    drawn = [
        plots.Series(f"reference, {name}", curve, (plots.Line(f"model, {name}", own.predict(curve)),))
        for name, curve in labelled
    ]
    return [
        page.finding(finding(flat, pivoted, own)),
        page.figures(
            [
                plots.delta_output("model tuned to the plate lying parallel", drawn, ANGLE),
                plots.deviations("tuned model less reference", drawn, ANGLE),
            ]
        ),
        page.folded("Show every tuning", tables.predictions(labelled, tunings, flat, ANGLE)),
        page.paragraph("The tuning to the plate lying parallel:"),
        tables.calibrations(tunings, flat),
        *measured_section.parts(labelled, ANGLE),
    ]


def finding(flat: Curve, pivoted: list[Curve], own: Calibration) -> str:
    """Tells the largest deviation over angle, whether it belongs to the nearest hinge, and how the angle changes it."""
    found = {curve.hinge_gap: summary(curve, own.predict(curve), flat) for curve in pivoted}
    seen = {gap: each for gap, each in found.items() if each.is_observable}
    if not seen:
        return "No pivoted plate is observable."
    worst = max(seen, key=lambda gap: abs(seen[gap].observable))
    largest = max(seen, key=lambda gap: seen[gap].rms)
    lying = summary(flat, own.predict(flat), flat)
    nearest = (
        "the nearest, as in the thesis" if largest == min(seen) else "where in the thesis it was the nearest"
    )
    turned = sorted(_change_over_angle(curve, own) for curve in pivoted)
    return (
        f"Tuned to the plate lying parallel ({signed_percent(lying.observable)} at most there), the model is off by up to "
        f"{signed_percent(seen[worst].observable)}, at {tables.place(seen[worst].observable_at, ANGLE)} with the hinge at "
        f"{tables.place(worst, DISTANCE)}; in volts most, {1000 * seen[largest].rms:.3g} mV rms, with the hinge at "
        f"{tables.place(largest, DISTANCE)}, {nearest}. From the least to the greatest angle the deviation changes by "
        f"{signed_percent(turned[0])} to {signed_percent(turned[-1])}; the thesis "
        "supposed that orientation has no effect."
    )


def _change_over_angle(curve: Curve, own: Calibration) -> float:
    values = deviation(curve, own.predict(curve)).value
    return float(values[-1] - values[0])
