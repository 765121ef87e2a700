"""The section of an experiment in the report of its study."""

from __future__ import annotations

from html import escape

from analysis import page
from analysis.experiments import claims, plots, tables
from analysis.experiments.calibration import (
    FORMS,
    OBSERVABLE,
    OWN,
    THESIS,
    Calibration,
    calibrate,
    summary,
    untuned,
)
from analysis.experiments.curves import ANGLE, DISTANCE, Curve, curves, with_flat_start
from analysis.experiments.splitting import Accuracy, accuracies
from analysis.results import Results

_TITLES = {
    "I": "Experiment I: splitting against the exact integral",
    "II": "Experiment II: tuning to one plate",
    "III": "Experiment III: other plate sizes",
    "IV": "Experiment IV: a pivoted plate",
}
_DELTA = (
    "Delta output: the sensor's output with nothing near less that with the plate. The reference's, with delta_self and the sensor's "
    "own capacitance in the divider, takes the place of the physical sensor's; its error bars are mostly too small to see. "
    "Tuned with the own capacitance counted, coupling capacitance and ε are free; in the thesis' divider only their ratio "
    "counts, and ε is free at the scene's coupling capacitance. Volts alike: the fit counts every volt as much, as an eye does on "
    "the plot; by error bars, in units of the reference's. Errors of the constants are standard errors with the scatter of the "
    f"residuals. Observable: at least {100 * OBSERVABLE:.0f} % of the greatest delta output of the plate tuned to. Points name their case."
)
_SPLITTING = (
    "Error: the model's capacitance by split:N less that by exact, over exact. Regions as seen along the sensor's normal: I in front "
    "of it, II beside an edge, III diagonal to a corner; the thesis has done this in region I, in one set-up."
)


def section(results: Results) -> str:
    """The section of the experiment that the study is; empty where it is none."""
    if not results.experiment:
        return ""
    title = _TITLES[results.experiment]
    if results.experiment == "I":
        parts = _splitting(accuracies(results))
    else:
        parts = _curves(results.experiment, curves(results))
    return page.section(title, *parts)


def _curves(experiment: str, found: list[Curve]) -> list[str]:
    flat = next((curve for curve in found if curve.family == "parallel"), None)
    if flat is None:
        return [page.paragraph("No curve over distance has both answers, so nothing can be tuned.")]
    try:
        tunings = [calibrate(flat, form) for form in FORMS]
    except ValueError as error:
        return [page.paragraph(f"Not tuned: {error}.")]
    if experiment == "II":
        parts = _one_plate(flat, tunings)
    elif experiment == "III":
        others = [curve for curve in found if curve.family == "parallel" and curve is not flat]
        parts = _sizes(flat, others, tunings)
    else:
        pivoted = [with_flat_start(curve, flat) for curve in found if curve.family == "inclined"]
        parts = _angles(flat, pivoted, tunings)
    return [*parts, page.soft(_DELTA)]


def _one_plate(flat: Curve, tunings: list[Calibration]) -> list[str]:
    chosen = {tuned.form: tuned for tuned in tunings}
    own, thesis = chosen[OWN], chosen[THESIS]
    lines = (
        plots.Line("tuned, own capacitance counted", own.predict(flat)),
        plots.Line("tuned, thesis' divider", thesis.predict(flat), "dash"),
        plots.Line("not tuned", untuned(flat), "dot"),
    )
    drawn = [plots.Series("reference", flat, lines)]
    return [
        page.finding(finding_on_tuning(flat, own, thesis)),
        page.figures(
            [
                plots.delta_output(f"plate of {tables.plate(flat)}", drawn, DISTANCE),
                plots.deviations("residuals", drawn, DISTANCE),
            ]
        ),
        tables.calibrations(tunings, flat),
    ]


def finding_on_tuning(flat: Curve, own: Calibration, thesis: Calibration) -> str:
    """How well the tuned model fits, beside the thesis' words."""
    fit, bare, before = (
        summary(flat, p, flat) for p in (own.predict(flat), thesis.predict(flat), untuned(flat))
    )
    greatest = float(flat.reference.max())
    return (
        f"Tuned by {tables.constants(own)}, the model misses the curve by {1000 * fit.rms:.3g} mV rms, {100 * fit.rms / greatest:.2g} % of "
        f"its greatest; while the plate is observable, to {tables.place(fit.observable_until, DISTANCE)}, by at most "
        f"{tables.percent(fit.observable)}, at {tables.place(fit.worst_at, DISTANCE)} by {tables.percent(fit.worst)}. Tuned as in "
        f"the thesis, by the ratio alone, it misses by {1000 * bare.rms:.3g} mV rms, not tuned by {1000 * before.rms:.3g}."
    )


def _sizes(flat: Curve, others: list[Curve], tunings: list[Calibration]) -> list[str]:
    own = next(tuned for tuned in tunings if tuned.form == OWN)
    labelled = [(tables.plate(curve), curve) for curve in [flat, *others]]
    drawn = [
        plots.Series(
            f"reference, {name}",
            curve,
            (plots.Line(f"tuned to {labelled[0][0]}: {name}", own.predict(curve)),),
        )
        for name, curve in labelled
    ]
    return [
        page.finding(finding_on_sizes(flat, others, own)),
        page.figures(
            [
                plots.delta_output("points: reference; lines: tuned model", drawn, DISTANCE),
                plots.deviations("tuned model less reference", drawn, DISTANCE),
            ]
        ),
        "<h3>Beside the thesis</h3>",
        _claims_table(flat, others, tunings),
        "<h3>Every tuning</h3>",
        tables.predictions(labelled, tunings, flat, DISTANCE),
    ]


def finding_on_sizes(flat: Curve, others: list[Curve], own: Calibration) -> str:
    """The greatest deviations on the plates that were not tuned to, beside the thesis'."""
    told = []
    for curve in others:
        found = summary(curve, own.predict(curve), flat)
        claim = claims.for_plate(curve.target_area, flat.target_area)
        beside = f" (thesis: at most {100 * claim.greatest:.0f} %, {_side(claim)})" if claim else ""
        told.append(
            f"{tables.percent(found.observable)} for {tables.plate(curve)} at {tables.place(found.observable_at, DISTANCE)}{beside}"
        )
    listed = " and ".join(told) if told else "no other plate was asked"
    return (
        f"Tuned to {tables.plate(flat)}, the model is off, while the plate is observable, by up to {listed}."
    )


def _side(claim: claims.PlateClaim) -> str:
    return "too low" if claim.is_low else "too high"


def _claims_table(flat: Curve, others: list[Curve], tunings: list[Calibration]) -> str:
    header = [
        "plate",
        "tuned",
        "thesis",
        "here, observable",
        "at",
        "mean sign",
        "thesis later",
        "here so from",
        "thesis' greatest held",
    ]
    rows = []
    for curve in others:
        claim = claims.for_plate(curve.target_area, flat.target_area)
        if claim is None:
            continue
        for tuned in tunings:
            held = claims.hold(curve, tuned.predict(curve), flat, claim)
            rows.append(
                [
                    escape(tables.plate(curve)),
                    escape(tuned.form.name),
                    f"up to {100 * claim.greatest:.0f} %, {_side(claim)}",
                    tables.percent(held.worst),
                    tables.place(held.worst_at, DISTANCE),
                    tables.percent(held.mean),
                    f"below {100 * claim.later:.0f} %",
                    "nowhere" if held.later_from is None else tables.place(held.later_from, DISTANCE),
                    "yes" if held.holds else "no",
                ]
            )
    return page.table(header, rows, text_columns=3)


def _angles(flat: Curve, pivoted: list[Curve], tunings: list[Calibration]) -> list[str]:
    own = next(tuned for tuned in tunings if tuned.form == OWN)
    labelled = [(f"hinge at {tables.place(curve.hinge_gap, DISTANCE)}", curve) for curve in pivoted]
    drawn = [
        plots.Series(f"reference, {name}", curve, (plots.Line(f"tuned, {name}", own.predict(curve)),))
        for name, curve in labelled
    ]
    return [
        page.finding(finding_on_angles(flat, pivoted, own)),
        page.figures(
            [
                plots.delta_output(
                    "points: reference; lines: model tuned to the parallel plate", drawn, ANGLE
                ),
                plots.deviations("tuned model less reference", drawn, ANGLE),
            ]
        ),
        tables.predictions(labelled, tunings, flat, ANGLE),
        "<h3>The tuning to the parallel plate</h3>",
        tables.calibrations(tunings, flat),
    ]


def finding_on_angles(flat: Curve, pivoted: list[Curve], own: Calibration) -> str:
    """The greatest deviation over angle, where, and whether it is at the nearest hinge, as in the thesis."""
    found = {curve.hinge_gap: summary(curve, own.predict(curve), flat) for curve in pivoted}
    seen = {gap: each for gap, each in found.items() if each.observable == each.observable}
    if not seen:
        return "No pivoted plate is observable."
    worst = max(seen, key=lambda gap: abs(seen[gap].observable))
    largest = max(seen, key=lambda gap: seen[gap].rms)
    lying = summary(flat, own.predict(flat), flat)
    nearest = (
        "the nearest, as in the thesis"
        if largest == min(seen)
        else "not the nearest, as it was in the thesis"
    )
    return (
        f"Tuned to the plate lying parallel ({tables.percent(lying.observable)} at most there), the model is off by up to "
        f"{tables.percent(seen[worst].observable)}, at {tables.place(seen[worst].observable_at, ANGLE)} with the hinge at "
        f"{tables.place(worst, DISTANCE)}; in volts most, {1000 * seen[largest].rms:.3g} mV rms, with the hinge at "
        f"{tables.place(largest, DISTANCE)}, {nearest}."
    )


def _splitting(found: list[Accuracy]) -> list[str]:
    if not found:
        return [page.paragraph("No case has answers of the model by split:N.")]
    header = ["region", "splits", "set-ups", "median", "worst", "below exact"]
    rows = [
        [
            escape(each.region),
            str(each.level),
            str(len(each.errors)),
            f"{100 * each.median:.3g} %",
            f"{100 * each.worst:.3g} %",
            str(sum(error < 0 for error in each.errors)),
        ]
        for each in found
    ]
    return [
        page.finding(finding_on_splitting(found)),
        page.figures([plots.splitting(found)]),
        page.folded("Show the figures", page.table(header, rows)),
        page.soft(_SPLITTING),
    ]


def finding_on_splitting(found: list[Accuracy]) -> str:
    """The error at the thesis' recommended level in every region, and how often splitting is too low."""
    levels = {each.level for each in found}
    level = claims.NEGLIGIBLE_FROM_LEVEL if claims.NEGLIGIBLE_FROM_LEVEL in levels else max(levels)
    regions = [each for each in found if each.level == level]
    told = ", ".join(
        f"{each.region} {100 * each.median:.2g} % ({100 * each.worst:.2g} %)" for each in regions
    )
    errors = [error for each in found for error in each.errors]
    low = sum(error < 0 for error in errors) / len(errors)
    return (
        f"After {level} splits, which the thesis recommends, the median error (the worst) is: {told}; splitting is below the exact "
        f"integral in {100 * low:.0f} % of all set-ups and levels."
    )
