"""Calibrates the model on a reference curve, as the thesis' Experiment II does, and predicts other curves with it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import curve_fit

from analysis.results.answers import Estimate
from analysis.topics.experiments.curves import Curve
from analysis.topics.experiments.curves import Divider

Array = NDArray[np.float64]

# Largest factor by which a constant may change; a constant that the curve does not determine ends there.
_FARTHEST = 1e6
# Relative tolerance of the fit: far below any standard error, well above rounding.
_TOLERANCE = 1e-12
# The thesis ends its curves where the plate is "hardly observable" (6.2): here at this fraction of the largest output.
OBSERVABLE = 0.05


@dataclass(frozen=True)
class Form:
    """Which constants are fitted. With `counts_own` the divider contains the sensor's own capacitance, and the coupling capacitance and
    the permittivity can both be determined; without, as in the thesis, only their ratio matters, and ε alone is free.
    `by_error_bars`: residuals are weighted by the reference's error bars; else all have the same weight.
    """

    name: str
    counts_own: bool
    by_error_bars: bool


THESIS = Form("thesis' divider, volts alike", counts_own=False, by_error_bars=False)
THESIS_BY_BARS = Form("thesis' divider, by error bars", counts_own=False, by_error_bars=True)
OWN = Form("own capacitance counted, volts alike", counts_own=True, by_error_bars=False)
OWN_BY_BARS = Form("own capacitance counted, by error bars", counts_own=True, by_error_bars=True)
FORMS = (OWN, OWN_BY_BARS, THESIS, THESIS_BY_BARS)


@dataclass(frozen=True)
class Calibration:
    """The calibrated constants with standard errors: the coupling capacitance (F; without error where it was held) and the relative
    permittivity. `own` (F) and `voltage` (V) were given. `misfit` is the residuals' rms in the fit's own units, error bars or
    volts, per degree of freedom."""

    form: Form
    coupling: Estimate
    permittivity: Estimate
    own: float
    voltage: float
    misfit: float

    @property
    def determined(self) -> bool:
        """Whether the standard error of each constant is smaller than the constant."""
        constants = (self.coupling, self.permittivity)
        return all(constant.error < constant.value for constant in constants)

    def predict(self, curve: Curve) -> Array:
        """Returns the delta output of the calibrated model at the points of a curve (V)."""
        divider = Divider(self.coupling.value, self.own, self.voltage)
        return divider.delta_output(self.permittivity.value * curve.model)


def untuned(curve: Curve) -> Array:
    """Returns the delta output (V) of the uncalibrated model: ε = 1, the scene's coupling capacitance, no own capacitance."""
    return Divider(curve.coupling, 0.0, curve.voltage).delta_output(curve.model)


def calibrate(curve: Curve, form: Form) -> Calibration:
    """Fits the constants by least squares over the points of a curve. ValueError with too few of them.

    Standard errors are those of the linearised problem, with the scatter of the residuals themselves where it exceeds the error
    bars (Birge's ratio): the model's form, not the reference's noise, is what does not fit.
    """
    free = 2 if form.counts_own else 1
    if len(curve.points) <= free:
        raise ValueError(f"{len(curve.points)} points are too few to fit {free} constants")
    own = curve.own.value if form.counts_own else 0.0

    def tuned(capacitance: Array, *logarithms: float) -> Array:
        coupling = curve.coupling * np.exp(logarithms[1]) if form.counts_own else curve.coupling
        return Divider(float(coupling), own, curve.voltage).delta_output(np.exp(logarithms[0]) * capacitance)

    sigma = curve.error if form.by_error_bars else np.ones(len(curve.points))
    # The unknowns are the logarithms of the constants, which stay positive and of the order of one.
    found, covariance = curve_fit(
        tuned,
        curve.model,
        curve.reference,
        p0=np.zeros(free),
        sigma=sigma,
        absolute_sigma=True,
        bounds=(-np.log(_FARTHEST), np.log(_FARTHEST)),
        xtol=_TOLERANCE,
        ftol=_TOLERANCE,
        gtol=_TOLERANCE,
    )
    residuals = (tuned(curve.model, *found) - curve.reference) / sigma
    misfit = float(np.sqrt(residuals @ residuals / (len(residuals) - free)))
    scale = max(1.0, misfit) if form.by_error_bars else misfit
    relative = scale * np.sqrt(np.diag(covariance))
    permittivity = float(np.exp(found[0]))
    coupling = curve.coupling * float(np.exp(found[1])) if form.counts_own else curve.coupling
    return Calibration(
        form=form,
        coupling=Estimate(coupling, coupling * float(relative[1]) if form.counts_own else 0.0),
        permittivity=Estimate(permittivity, permittivity * float(relative[0])),
        own=own,
        voltage=curve.voltage,
        misfit=misfit,
    )


@dataclass(frozen=True, eq=False)
class Deviation:
    """(prediction − reference)/reference at the points of a curve, with the reference's error bars carried over."""

    at: Array
    value: Array
    low: Array
    high: Array

    @property
    def worst(self) -> int:
        """The point of the largest deviation."""
        return int(np.argmax(np.abs(self.value)))

    def within(self, limit: float) -> float | None:
        """Returns the place from which to the end of the curve the deviation is below `limit`; None if the last point is not."""
        outside = np.flatnonzero(np.abs(self.value) >= limit)
        first = 0 if len(outside) == 0 else int(outside[-1]) + 1
        return float(self.at[first]) if first < len(self.at) else None


def deviation(curve: Curve, prediction: Array) -> Deviation:
    """Computes the relative deviation of a prediction (V)."""
    reference, error = curve.reference, curve.error
    # The deviation has no upper bound if the interval contains zero.
    least = np.maximum(reference - error, np.finfo(np.float64).tiny)
    value, low, high = (np.asarray(prediction / true - 1) for true in (reference, reference + error, least))
    return Deviation(curve.at, value, low, high)


@dataclass(frozen=True)
class Summary:
    """The error of a prediction over a curve: rms in V; the largest relative deviation and its place, over all points and over those
    where the reference's output is at least `OBSERVABLE` of the calibration's largest.
    """

    rms: float
    worst: float
    worst_at: float
    observable: float
    observable_at: float
    observable_until: float

    @property
    def is_observable(self) -> bool:
        """Whether any point is observable."""
        return not math.isnan(self.observable)


def summary(curve: Curve, prediction: Array, calibrated_on: Curve) -> Summary:
    """Computes the summary of a prediction (V); NaN for observable points if there are none."""
    found = deviation(curve, prediction)
    seen = np.flatnonzero(curve.reference >= OBSERVABLE * calibrated_on.reference.max())
    residuals = prediction - curve.reference
    if len(seen) == 0:
        observable = observable_at = until = math.nan
    else:
        place = seen[np.argmax(np.abs(found.value[seen]))]
        observable, observable_at = float(found.value[place]), float(found.at[place])
        until = float(found.at[seen].max())
    return Summary(
        rms=float(np.sqrt(np.mean(residuals**2))),
        worst=float(found.value[found.worst]),
        worst_at=float(found.at[found.worst]),
        observable=observable,
        observable_at=observable_at,
        observable_until=until,
    )
