"""Figures of the experiments: delta output and deviation over distance or angle."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analysis.report.plot import Panel, axis, figure, joined, log_axis, marks, series_colour
from analysis.results.units import CENTIMETRE
from analysis.topics.experiments.curves import DISTANCE, Curve
from analysis.topics.experiments.words import Labelled

Array = NDArray[np.float64]


def delta_output(labelled: Labelled, swept: str) -> Panel:
    """Returns the reference as points with error bars and the model as lines, as the thesis plots them."""
    traces: list[object] = []
    for index, (name, curve) in enumerate(labelled):
        colour, at = series_colour(index), across(curve, swept)
        hover = f"reference, {name}: " + "%{y:.4g} V<br>%{text}<extra></extra>"
        marker, more = {"color": colour, "size": 8}, {"text": curve.cases, "customdata": curve.cases}
        traces.append(marks(f"reference, {name}", at, curve.reference, marker, hover, curve.error, **more))
        traces.append(joined(f"model, {name}", at, curve.untuned, colour, "%{y:.4g} V", mode="lines"))
    y = axis("delta output (V)", rangemode="tozero")
    return Panel("delta output", figure(traces, axis_of(swept), y, 440))


def ratios(labelled: Labelled, swept: str) -> Panel:
    """Plots the model's delta output over the reference's."""
    traces: list[object] = []
    for index, (name, curve) in enumerate(labelled):
        more = {"text": curve.cases, "customdata": curve.cases}
        values = curve.untuned / curve.reference
        bars = values * curve.error / curve.reference
        hover = "%{y:.4g} times<br>%{text}"
        traces.append(joined(name, across(curve, swept), values, series_colour(index), hover, bars, **more))
    y = axis("model over reference", rangemode="tozero")
    return Panel("the model's over the reference's", figure(traces, axis_of(swept), y, 440))


def across(curve: Curve, swept: str) -> Array:
    """Returns the distances in cm or the angles in degrees of a curve."""
    return curve.at / CENTIMETRE if swept == DISTANCE else curve.at


def axis_of(swept: str) -> dict[str, object]:
    """Returns the axis of distances or of angles."""
    return log_axis("distance (cm)") if swept == DISTANCE else axis("angle (degrees)", dtick=15)
