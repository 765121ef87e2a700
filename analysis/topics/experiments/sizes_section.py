"""Experiment III in the report: the model calibrated on one plate predicts others."""

from __future__ import annotations

from markupsafe import Markup

from analysis.report import page
from analysis.results.units import signed_percent
from analysis.topics.experiments import claims, measured_section, plots, tables
from analysis.topics.experiments.calibration import OWN, Calibration, summary
from analysis.topics.experiments.curves import DISTANCE, Curve


def parts(flat: Curve, others: list[Curve], tunings: list[Calibration]) -> list[Markup]:
    """Returns the finding, the curves, the deviations, the thesis' figures beside them, and every calibration."""
    own = next(tuned for tuned in tunings if tuned.form == OWN)
    labelled = [(tables.plate(curve), curve) for curve in [flat, *others]]
    drawn = [
        plots.Series(f"reference, {name}", curve, (plots.Line(f"model, {name}", own.predict(curve)),))
        for name, curve in labelled
    ]
    return [
        page.finding(finding(flat, others, own)),
        page.figures(
            [
                plots.delta_output(f"model tuned to {tables.plate(flat)}", drawn, DISTANCE),
                plots.deviations("tuned model less reference", drawn, DISTANCE),
            ]
        ),
        page.paragraph("Beside the thesis, while the plate is observable:"),
        _claims_table(flat, others, tunings),
        page.folded(
            "Show every tuning",
            tables.calibrations(tunings, flat) + tables.predictions(labelled, tunings, flat, DISTANCE),
        ),
        *measured_section.parts(labelled, DISTANCE),
    ]


def finding(flat: Curve, others: list[Curve], own: Calibration) -> str:
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
