"""Experiments I to IV in the report: which quantity the thesis could have measured, beside the one that its formula stands for."""

from __future__ import annotations

from markupsafe import Markup

from analysis.report import page
from analysis.report.plot import Panel, figure, joined, power_axis, series_colour
from analysis.results.units import PICOFARAD
from analysis.topics.experiments import plots, words

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


def parts(labelled: words.Labelled, swept: str) -> list[Markup]:
    """Returns the ratio of change to mutual, and a figure of both, for curves with their names."""
    return [
        page.finding(finding(labelled, swept)),
        page.figures([_both(labelled, swept)]),
    ]


def finding(labelled: words.Labelled, swept: str) -> str:
    """Tells how much of mutual the change is on every curve."""
    ranges = words.ranges(labelled, lambda curve: curve.change_over_mutual, swept)
    return f"The change of the reading, over mutual: {ranges}."


def _both(labelled: words.Labelled, swept: str) -> Panel:
    traces = []
    for index, (name, curve) in enumerate(labelled):
        for what, dash in (("change", "solid"), ("mutual", "dot")):
            estimates = [getattr(point, what) for point in curve.points]
            values, bars = (
                [getattr(estimate, part) / PICOFARAD for estimate in estimates] for part in ("value", "error")
            )
            across, colour, hover = plots.across(curve, swept), series_colour(index), "%{y:.4g} pF<br>%{text}"
            more = {"dash": dash, "text": curve.cases, "customdata": curve.cases}
            traces.append(joined(f"{what}, {name}", across, values, colour, hover, bars, **more))
    y = power_axis("capacitance (pF)")
    return Panel(
        "change of the reading, and mutual, by the reference", figure(traces, plots.axis_of(swept), y, 440)
    )
