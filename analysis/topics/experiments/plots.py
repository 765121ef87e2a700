"""Figures of the experiments: delta output and deviation over distance or angle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray

from analysis.report.plot import Panel, axis, figure, joined, log_axis, marks, series_colour
from analysis.topics.experiments.calibration import deviation
from analysis.topics.experiments.curves import DISTANCE, Curve

Array = NDArray[np.float64]

CENTIMETRE, PERCENT, PER_MILLE = 0.01, 100.0, 1000.0


@dataclass(frozen=True, eq=False)
class Line:
    """A prediction (V) of a curve, the line's name and its dash as plotly calls it."""

    name: str
    prediction: Array
    dash: str = "solid"


@dataclass(frozen=True, eq=False)
class Series:
    """A curve with its name and the predictions of it."""

    name: str
    curve: Curve
    lines: tuple[Line, ...]


def delta_output(caption: str, series: list[Series], swept: str) -> Panel:
    """Returns the reference as points with error bars, predictions as lines, as the thesis plots them."""
    traces: list[object] = []
    for index, each in enumerate(series):
        colour = series_colour(index)
        traces.append(_reference(each, swept, colour))
        for number, line in enumerate(each.lines):
            shade, at = _line_colour(series, index, number), across(each.curve, swept)
            traces.append(
                joined(line.name, at, line.prediction, shade, "%{y:.4g} V", mode="lines", dash=line.dash)
            )
    return Panel(caption, figure(traces, axis_of(swept), axis("delta output (V)", rangemode="tozero"), 440))


def deviations(caption: str, series: list[Series], swept: str) -> Panel:
    """Plots (prediction − reference)/reference with the reference's error bars."""
    traces: list[object] = []
    for line, colour, curve in _lines(series):
        found = deviation(curve, line.prediction)
        values = np.asarray(PERCENT * found.value)
        bars: dict[str, object] = {
            "symmetric": False,
            "array": PERCENT * (found.high - found.value),
            "arrayminus": PERCENT * (found.value - found.low),
        }
        traces.append(_differences(line, colour, curve, swept, (values, bars, "%")))
    return Panel(caption, figure(traces, axis_of(swept), axis("model less reference (%)"), 440))


def residuals(caption: str, series: list[Series], swept: str) -> Panel:
    """Plots prediction − reference with the reference's error bars."""
    traces: list[object] = []
    for line, colour, curve in _lines(series):
        values = np.asarray(PER_MILLE * (line.prediction - curve.reference))
        bars: dict[str, object] = {"array": PER_MILLE * curve.error}
        traces.append(_differences(line, colour, curve, swept, (values, bars, "mV")))
    return Panel(caption, figure(traces, axis_of(swept), axis("model less reference (mV)"), 440))


def _reference(series: Series, swept: str, colour: str) -> go.Scatter:
    curve, hover = series.curve, series.name + ": %{y:.4g} V<br>%{text}<extra></extra>"
    cases = [point.case for point in curve.points]
    marker, more = {"color": colour, "size": 8}, {"text": cases, "customdata": cases}
    return marks(series.name, across(curve, swept), curve.reference, marker, hover, curve.error, **more)


def _lines(series: list[Series]) -> list[tuple[Line, str, Curve]]:
    return [
        (line, _line_colour(series, index, number), each.curve)
        for index, each in enumerate(series)
        for number, line in enumerate(each.lines)
    ]


def _differences(
    line: Line, colour: str, curve: Curve, swept: str, what: tuple[Array, dict[str, object], str]
) -> go.Scatter:
    values, bars, unit = what
    return go.Scatter(
        x=across(curve, swept),
        y=values,
        error_y={"type": "data", "thickness": 1.5, **bars},
        mode="lines+markers",
        line={"color": colour, "dash": line.dash, "width": 2},
        marker={"color": colour, "size": 6},
        name=line.name,
        text=[point.case for point in curve.points],
        customdata=[point.case for point in curve.points],
        hovertemplate=line.name + ": %{y:+.3g} " + unit + "<br>%{text}<extra></extra>",
    )


def _line_colour(series: list[Series], index: int, number: int) -> str:
    """Returns the colour of a curve's points; with a single curve each line has its own."""
    return series_colour(index if len(series) > 1 else number + 1)


def across(curve: Curve, swept: str) -> Array:
    """Returns the distances in cm or the angles in degrees of a curve."""
    return curve.at / CENTIMETRE if swept == DISTANCE else curve.at


def axis_of(swept: str) -> dict[str, object]:
    """Returns the axis of distances or of angles."""
    return log_axis("distance (cm)") if swept == DISTANCE else axis("angle (degrees)", dtick=15)
