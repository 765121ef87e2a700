"""Experiment I in the report: the error of splitting over its level in each region."""

from __future__ import annotations

from markupsafe import Markup

from analysis.report import page
from analysis.topics.experiments import claims, plots
from analysis.topics.experiments.splitting import Accuracy

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
        page.figures([plots.splitting(found)]),
        page.folded("Show the figures", table),
        page.soft(_EXPLANATION),
    ]


def finding(found: list[Accuracy]) -> str:
    """Tells the error at the thesis' recommended level in every region, and how often splitting gives too little."""
    levels = {each.level for each in found}
    recommended = claims.NEGLIGIBLE_FROM_LEVEL
    level = recommended if recommended in levels else max(levels)
    regions = [each for each in found if each.level == level]
    phrases = ", ".join(
        f"{each.region} {100 * each.median:.2g} % ({100 * each.worst:.2g} %)" for each in regions
    )
    errors = [error for each in found for error in each.errors]
    low = sum(error < 0 for error in errors) / len(errors)
    return (
        f"After {level} splits (the thesis: negligible from {recommended} on) the median error, and in brackets the worst, is: {phrases}; "
        f"splitting is below the exact integral in {100 * low:.0f} % of all set-ups and levels."
    )
