"""Experiment II in the report: the model calibrated on one plate over distance."""

from __future__ import annotations

from markupsafe import Markup

from analysis.report import page
from analysis.results.units import signed_percent
from analysis.topics.experiments import measured_section, plots, tables
from analysis.topics.experiments.calibration import OWN, THESIS, Calibration, summary, untuned
from analysis.topics.experiments.curves import DISTANCE, Curve


def parts(flat: Curve, tunings: list[Calibration]) -> list[Markup]:
    """Returns the finding, the curve, the residuals and the constants."""
    chosen = {tuned.form: tuned for tuned in tunings}
    own, thesis = chosen[OWN], chosen[THESIS]
    lines = (
        plots.Line("tuned, own capacitance counted", own.predict(flat)),
        plots.Line("tuned, thesis' divider", thesis.predict(flat), "dash"),
        plots.Line("not tuned", untuned(flat), "dot"),
    )
    drawn, tuned = ([plots.Series("reference", flat, shown)] for shown in (lines, lines[:2]))
    return [
        page.finding(finding(flat, own, thesis)),
        page.figures(
            [
                plots.delta_output(f"plate of {tables.plate(flat)}", drawn, DISTANCE),
                plots.residuals("residuals of the tuned model", tuned, DISTANCE),
                plots.deviations("the same, relative", tuned, DISTANCE),
            ]
        ),
        tables.calibrations(tunings, flat),
        *measured_section.parts([(f"plate of {tables.plate(flat)}", flat)], DISTANCE),
    ]


def finding(flat: Curve, own: Calibration, thesis: Calibration) -> str:
    """Tells how well the model fits with either calibration, and without."""
    predictions = (own.predict(flat), thesis.predict(flat), untuned(flat))
    fit, bare, before = (summary(flat, prediction, flat) for prediction in predictions)
    share = 100 * fit.rms / float(flat.reference.max())
    beyond = f", at {tables.place(fit.worst_at, DISTANCE)} by {signed_percent(fit.worst)}"
    farther = beyond if fit.worst_at > fit.observable_until else ""
    return (
        f"Tuned by {tables.constants(own)}, the model misses the curve by {1000 * fit.rms:.3g} mV rms, {share:.2g} % of its "
        f"greatest; while the plate is observable, to {tables.place(fit.observable_until, DISTANCE)}, by at most "
        f"{signed_percent(fit.observable)}{farther}. Tuned as in the thesis, by the ratio alone, it misses by "
        f"{1000 * bare.rms:.3g} mV rms, not tuned by {1000 * before.rms:.3g} mV."
    )
