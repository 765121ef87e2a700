"""Fine-tuning of the model to a reference curve, as the thesis' Experiment II does, and what the model predicts then."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import curve_fit

from analysis.results.answers import Estimate
from analysis.topics.experiments.curves import Curve
from analysis.topics.experiments.divider import Divider

Array = NDArray[np.float64]

# How many times greater or smaller than given a constant may become: where the curve leaves one open, it runs there.
_FARTHEST = 1e6
# Far below any standard error, well above rounding.
_TOLERANCE = 1e-12
# The thesis ends its curves where the plate is "hardly observable" (6.2): here at this part of the calibration's greatest output.
OBSERVABLE = 0.05


@dataclass(frozen=True)
class Form:
    """What may be tuned. `counts_own`: the sensor's own capacitance stands in the divider, and with it the coupling
    capacitance can be told from the permittivity; without, as in the thesis, only their ratio counts and ε alone is free.
    `by_error_bars`: residuals count in units of the reference's error bars; else all volts count alike, as to an eye.
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
    """The tuned constants with standard errors: the coupling capacitance (F; without error where it was held) and the relative
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
        """Whether the curve tells each constant at least to its own size."""
        constants = (self.coupling, self.permittivity)
        return all(constant.error < constant.value for constant in constants)

    def predict(self, curve: Curve) -> Array:
        """Returns the delta output of the tuned model at the points of a curve (V)."""
        divider = Divider(self.coupling.value, self.own, self.voltage)
        return divider.delta_output(self.permittivity.value * curve.model)


def untuned(curve: Curve) -> Array:
    """Returns the delta output of the model as it comes: ε = 1, the scene's coupling capacitance, nothing of the sensor's own (V)."""
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
    # Both constants enter by their logarithms: positive, and of the order of one.
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
        """The point of the greatest deviation."""
        return int(np.argmax(np.abs(self.value)))

    def within(self, limit: float) -> float | None:
        """Returns the place from which to the end of the curve the deviation is below `limit`; None if the last point is not."""
        outside = np.flatnonzero(np.abs(self.value) >= limit)
        first = 0 if len(outside) == 0 else int(outside[-1]) + 1
        return float(self.at[first]) if first < len(self.at) else None


def deviation(curve: Curve, prediction: Array) -> Deviation:
    """Returns how far a prediction (V) is off."""
    reference, error = curve.reference, curve.error
    # An interval that reaches zero leaves the deviation open upwards.
    least = np.maximum(reference - error, np.finfo(np.float64).tiny)
    value, low, high = (np.asarray(prediction / true - 1) for true in (reference, reference + error, least))
    return Deviation(curve.at, value, low, high)


@dataclass(frozen=True)
class Summary:
    """How far a prediction is off over a curve: rms in V; the greatest relative deviation and where, and the
    same among the points where the reference's output is at least `OBSERVABLE` of the calibration's greatest.
    """

    rms: float
    worst: float
    worst_at: float
    observable: float
    observable_at: float
    observable_until: float

    @property
    def is_observable(self) -> bool:
        """Whether any point is."""
        return not math.isnan(self.observable)


def summary(curve: Curve, prediction: Array, calibrated_on: Curve) -> Summary:
    """Returns the figures of a prediction (V); those of observable points are NaN without any."""
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
