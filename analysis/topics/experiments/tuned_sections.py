"""Experiments II to IV in the report: the model calibrated on one plate over distance, held against it, against other plates, and pivoted ones."""

from __future__ import annotations

from markupsafe import Markup

from analysis.report import page
from analysis.results.units import signed_percent
from analysis.topics.experiments import claims, measured_section, plots, tables
from analysis.topics.experiments.calibration import OWN, THESIS, Calibration, deviation, summary, untuned
from analysis.topics.experiments.curves import ANGLE, DISTANCE, Curve


def one_plate(flat: Curve, tunings: list[Calibration]) -> list[Markup]:
    """Returns Experiment II: the finding, the curve, the residuals and the constants."""
    own, thesis = _tuned(tunings), next(tuned for tuned in tunings if tuned.form == THESIS)
    lines = (
        plots.Line("tuned, own capacitance counted", own.predict(flat)),
        plots.Line("tuned, thesis' divider", thesis.predict(flat), "dash"),
        plots.Line("not tuned", untuned(flat), "dot"),
    )
    drawn, tuned = ([plots.Series("reference", flat, shown)] for shown in (lines, lines[:2]))
    panels = [
        plots.delta_output(f"plate of {tables.plate(flat)}", drawn, DISTANCE),
        plots.residuals("residuals of the tuned model", tuned, DISTANCE),
        plots.deviations("the same, relative", tuned, DISTANCE),
    ]
    return [
        page.finding(finding_on_one_plate(flat, own, thesis)),
        page.figures(panels),
        tables.calibrations(tunings, flat),
        *measured_section.parts([(f"plate of {tables.plate(flat)}", flat)], DISTANCE),
    ]


def other_sizes(flat: Curve, others: list[Curve], tunings: list[Calibration]) -> list[Markup]:
    """Returns Experiment III: the finding, the curves, the deviations, the thesis' figures beside them, and every calibration."""
    labelled = [(tables.plate(curve), curve) for curve in [flat, *others]]
    every = tables.calibrations(tunings, flat) + tables.predictions(labelled, tunings, flat, DISTANCE)
    return [
        page.finding(finding_on_sizes(flat, others, _tuned(tunings))),
        _curves(f"model tuned to {tables.plate(flat)}", labelled, tunings, DISTANCE),
        page.paragraph("Beside the thesis, while the plate is observable:"),
        _claims_table(flat, others, tunings),
        page.folded("Show every tuning", every),
        *measured_section.parts(labelled, DISTANCE),
    ]


def pivoted_plates(flat: Curve, pivoted: list[Curve], tunings: list[Calibration]) -> list[Markup]:
    """Returns Experiment IV: the finding, the curves over angle, the deviations, and every calibration with its constants."""
    labelled = [(f"hinge at {tables.place(curve.hinge_gap, DISTANCE)}", curve) for curve in pivoted]
    return [
        page.finding(finding_on_angles(flat, pivoted, _tuned(tunings))),
        _curves("model tuned to the plate lying parallel", labelled, tunings, ANGLE),
        page.folded("Show every tuning", tables.predictions(labelled, tunings, flat, ANGLE)),
        page.paragraph("The tuning to the plate lying parallel:"),
        tables.calibrations(tunings, flat),
        *measured_section.parts(labelled, ANGLE),
    ]


def _tuned(tunings: list[Calibration]) -> Calibration:
    """Returns the calibration in which the sensor's own capacitance counts."""
    return next(tuned for tuned in tunings if tuned.form == OWN)


def _curves(
    caption: str, labelled: list[tuple[str, Curve]], tunings: list[Calibration], swept: str
) -> Markup:
    """Plots curves beside the model's, and what is between them."""
    own = _tuned(tunings)
    drawn = [
        plots.Series(f"reference, {name}", curve, (plots.Line(f"model, {name}", own.predict(curve)),))
        for name, curve in labelled
    ]
    deviations = plots.deviations("tuned model less reference", drawn, swept)
    return page.figures([plots.delta_output(caption, drawn, swept), deviations])


def finding_on_one_plate(flat: Curve, own: Calibration, thesis: Calibration) -> str:
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


def finding_on_sizes(flat: Curve, others: list[Curve], own: Calibration) -> str:
    """Compares the largest deviations on the other plates with the thesis'."""
    phrases, signs = [], []
    for curve in others:
        claim = claims.for_plate(curve.target_area, flat.target_area)
        held = claims.hold(curve, own.predict(curve), flat, claim) if claim else None
        if claim is None or held is None:
            continue
        signs.append((held.mean < 0) == claim.is_low)
        phrases.append(
            f"{signed_percent(held.worst)} for {tables.plate(curve)} at {tables.place(held.worst_at, DISTANCE)} (thesis: at most "
            f"{100 * claim.greatest:.0f} % on a {'smaller' if claim.is_low else 'larger'} plate)"
        )
    if not phrases:
        return "The study holds no observable plate of another size."
    lying = summary(flat, own.predict(flat), flat)
    agreeing = "for all of them here" if all(signs) else f"for {sum(signs)} of {len(signs)} here"
    return (
        f"Tuned to {tables.plate(flat)}, where it is {signed_percent(lying.observable)} off at most, the model is off by up to "
        f"{' and '.join(phrases)}, while the plate is observable. In the thesis smaller plates come out too low and larger ones too high; "
        f"on the average over distance that is so {agreeing}."
    )


def _claims_table(flat: Curve, others: list[Curve], tunings: list[Calibration]) -> Markup:
    known = [
        (curve, tuned, claim, held)
        for curve in others
        if (claim := claims.for_plate(curve.target_area, flat.target_area))
        for tuned in tunings
        if (held := claims.hold(curve, tuned.predict(curve), flat, claim))
    ]
    rows = [
        [
            tables.plate(curve),
            tuned.form.name,
            f"{100 * claim.greatest:.0f} %, too {'low' if claim.is_low else 'high'}",
            signed_percent(held.worst),
            tables.place(held.worst_at, DISTANCE),
            signed_percent(held.mean),
            "yes" if held.holds else "no",
            f"below {100 * claim.later:.0f} %",
            "nowhere" if held.later_from is None else tables.place(held.later_from, DISTANCE),
        ]
        for curve, tuned, claim, held in known
    ]
    thesis = ["thesis: greatest", "here", "at", "mean", "within it", "thesis: later", "here so from"]
    return page.table(["plate", "tuned", *thesis], rows, text_columns=2)


def finding_on_angles(flat: Curve, pivoted: list[Curve], own: Calibration) -> str:
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
