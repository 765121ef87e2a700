"""Curves of delta output over distance or angle, from the answers of a study, and the divider that makes it (thesis 5.3.5 and chapter 6)."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import plotly.graph_objects as go

from analysis.report.plot import Panel, axis, figure, joined, log_axis, marks, series_colour
from analysis.results.answers import Estimate
from analysis.results.statistics import grouped
from analysis.results.study_results import COMPARED_METHOD, CaseResult, Results
from analysis.results.units import CENTIMETRE
from geometries.common.arrays import Array
from geometries.common.measured import PICOFARAD
from geometries.studies.study import Parameter

DISTANCE, ANGLE = "gap", "tilt_degrees"
_HINGE = "hinge_gap"
# The parameter that a family is swept over; the other parameters distinguish its curves.
_SWEPT = {"parallel": DISTANCE, "inclined": ANGLE}


def delta_output(capacitance: Array, own: float, coupling: float, voltage: float) -> Array:
    """Returns the divider's output V_in·C_c/(C_c + C_own + C) without objects minus that with them (V), which the thesis plots, for the
    capacitances C that nearby objects add. `coupling` is the upper capacitor and `own` the sensor's capacitance without objects (F); `voltage`
    is the input (V)."""
    base = coupling + own
    return np.asarray(voltage * coupling * capacitance / (base * (base + capacitance)))


def reference_delta_output(own: Estimate, delta_self: Estimate, coupling: float, voltage: float) -> Estimate:
    """Returns the delta output (V) of a sensor whose own capacitance and whose change are known with errors (F).
    The absolute contributions of the two errors are added, to first order."""
    base = coupling + own.value
    near = base + delta_self.value
    by_change = voltage * coupling / near**2
    by_own = voltage * coupling * abs(1 / near**2 - 1 / base**2)
    value = voltage * coupling * delta_self.value / (base * near)
    return Estimate(value, by_change * delta_self.error + by_own * own.error)


@dataclass(frozen=True)
class Point:
    """One set-up: `at` is the distance (m) or the angle (degrees), `model` the exact model's capacitance (F). By the reference:
    the delta output `reference` (V), `mutual` and the `change` of the sensor's reading (F), which in empty space is delta_self.
    """

    case: str
    at: float
    model: float
    reference: Estimate
    mutual: Estimate
    change: Estimate


@dataclass(frozen=True, eq=False)
class Curve:
    """Points in the order of `at`, with the values that they share: lengths in metres, F, V."""

    family: str
    parameters: dict[str, Parameter]
    own: Estimate
    coupling: float
    voltage: float
    points: tuple[Point, ...]

    @property
    def at(self) -> Array:
        return np.array([point.at for point in self.points])

    @property
    def model(self) -> Array:
        return np.array([point.model for point in self.points])

    @property
    def reference(self) -> Array:
        return np.array([point.reference.value for point in self.points])

    @property
    def error(self) -> Array:
        return np.array([point.reference.error for point in self.points])

    @property
    def untuned(self) -> Array:
        """The model's delta output (V) as the thesis computes it: ε = 1, the scene's coupling capacitance, no own capacitance."""
        return delta_output(self.model, 0.0, self.coupling, self.voltage)

    @property
    def change_over_mutual(self) -> Array:
        return np.array([point.change.value / point.mutual.value for point in self.points])

    @property
    def cases(self) -> list[str]:
        return [point.case for point in self.points]

    def size(self, name: str) -> tuple[float, float]:
        """Returns the sides (m) of a plate, the sensor or the target."""
        size = self.parameters[f"{name}_size"]
        assert isinstance(size, tuple)
        return size

    @property
    def hinge_gap(self) -> float:
        """The height of a pivoted plate's hinge (m)."""
        gap = self.parameters[_HINGE]
        assert isinstance(gap, float)
        return gap


def curves(results: Results) -> list[Curve]:
    """Returns a curve for each plate over distance and for each hinge over angle, in the study's order. Cases of other families, those
    without both answers or without the sensor alone, and floating targets, which have no mutual, are left out.
    """
    answered = (case for case in results.compared() if case.family in _SWEPT and is_answered(results, case))
    alike = grouped(answered, lambda case: (case.family, *_same(case).items()))
    return [_curve(results, members) for members in alike.values()]


def with_flat_start(curve: Curve, flat: Curve) -> Curve:
    """Returns a curve over angle with the parallel plate of the same size at the hinge's height as its angle 0, where there is one.
    Hinged to the sensor's edge, a plate is centred before the sensor only if they are equally wide."""
    target = curve.size("target")
    if flat.size("target") != target or target[0] != curve.size("sensor")[0] or curve.points[0].at <= 0:
        return curve
    start = tuple(replace(point, at=0.0) for point in flat.points if point.at == curve.hinge_gap)
    return replace(curve, points=start + curve.points)


def is_answered(results: Results, case: CaseResult) -> bool:
    """Tells whether a case has both answers, and the same without objects a reference's."""
    empty = results.cases.get(case.empty)
    return (
        case.truth is not None
        and case.model is not None
        and empty is not None
        and empty.truth is not None
        and case.scene.objects[0].name in case.truth.conductors
    )


def _same(case: CaseResult) -> dict[str, Parameter]:
    return {name: value for name, value in case.parameters.items() if name != _SWEPT[case.family]}


def _curve(results: Results, members: list[CaseResult]) -> Curve:
    first = members[0]
    alone = results.cases[first.empty].truth
    assert alone is not None
    sensor = first.scene.sensors[0]
    own = alone.self_capacitance(sensor.name).best
    points = []
    for case in members:
        assert case.truth is not None and case.model is not None
        change = case.truth.delta_self(sensor.name).best
        points.append(
            Point(
                case.id,
                number(case, _SWEPT[case.family]),
                case.model.values[COMPARED_METHOD][sensor.name].total,
                reference_delta_output(own, change, sensor.coupling_capacitance, sensor.input_voltage),
                case.truth.mutual(sensor.name, case.scene.objects[0].name).best,
                change,
            )
        )
    ordered = tuple(sorted(points, key=lambda point: point.at))
    return Curve(first.family, _same(first), own, sensor.coupling_capacitance, sensor.input_voltage, ordered)


def number(case: CaseResult, name: str) -> float:
    """Returns a parameter of a case that is a number."""
    value = case.parameters[name]
    assert isinstance(value, float)
    return value


Labelled = list[tuple[str, Curve]]
"""Curves with their names."""


def ranges(labelled: Labelled, values: Callable[[Curve], Array], swept: str) -> str:
    """Writes the least and the greatest value along each curve, with their places."""
    phrases = []
    for name, curve in labelled:
        found = values(curve)
        ends = [int(np.argmin(found)), int(np.argmax(found))]
        told = [f"{found[index]:.3g} (at {place(float(curve.at[index]), swept)})" for index in ends]
        phrases.append(f"{name} {' to '.join(told)}")
    return "; ".join(phrases)


def place(at: float, swept: str) -> str:
    """Writes a distance in cm or an angle in degrees."""
    return f"{at / CENTIMETRE:.3g} cm" if swept == DISTANCE else f"{at:.3g}°"


def size(lengths: tuple[float, float]) -> str:
    """Writes lengths in metres as centimetres."""
    x, y = lengths
    return f"{x / CENTIMETRE:.3g} cm × {y / CENTIMETRE:.3g} cm"


def delta_outputs(labelled: Labelled, swept: str) -> Panel:
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
        values, more = curve.untuned / curve.reference, {"text": curve.cases, "customdata": curve.cases}
        bars, hover = values * curve.error / curve.reference, "%{y:.4g} times<br>%{text}"
        traces.append(joined(name, across(curve, swept), values, series_colour(index), hover, bars, **more))
    y = axis("model over reference", rangemode="tozero")
    return Panel("the model's over the reference's", figure(traces, axis_of(swept), y, 440))


def estimated(
    name: str, x: Any, found: Iterable[Estimate], colour: str, hover: str, **more: Any
) -> go.Scatter:
    """Returns capacitances in pF, joined by lines, with their errors as bars."""
    values, errors = zip(*((each.value / PICOFARAD, each.error / PICOFARAD) for each in found))
    return joined(name, x, values, colour, hover, errors, **more)


def across(curve: Curve, swept: str) -> Array:
    """Returns the distances in cm or the angles in degrees of a curve."""
    return curve.at / CENTIMETRE if swept == DISTANCE else curve.at


def axis_of(swept: str) -> dict[str, object]:
    """Returns the axis of distances or of angles."""
    return log_axis("distance (cm)") if swept == DISTANCE else axis("angle (degrees)", dtick=15)
