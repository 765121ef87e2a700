"""A Gaussian process that predicts the remaining error of a correction from a few features of a set-up."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.topics.corrections.estimates import Array, Errors, Estimates

# Folds of the cross-validation.
_FOLDS = 10
_SEED = 1
_CONFIDENCE = 0.95


@dataclass(frozen=True)
class Discrepancy:
    """Errors of correction and process together, in set-ups the process has not seen, and which share of the 95 % intervals holds
    the truth: with ten folds of the open two thirds, and trained on all of them for the sealed third.

    The residuals are not quite normal: the width of an interval, in standard deviations, is calibrated on the other folds.
    """

    correction: str
    open_: Errors
    open_coverage: float
    sealed: Errors
    sealed_coverage: float


def discrepancy(found: Estimates, correction: str) -> Discrepancy:
    """Fits ln(truth/correction); the features of a set-up are ratios of the registry's own estimates."""
    described = _described(found, correction)
    left = -np.log1p(found.errors(correction))
    opened = np.flatnonzero(~found.sealed)
    folds = np.random.default_rng(_SEED).permutation(len(opened)) % _FOLDS
    mean, deviation = np.empty_like(left), np.empty_like(left)
    for fold in range(_FOLDS):
        train, test = opened[folds != fold], opened[folds == fold]
        mean[test], deviation[test] = _predicted(described[train], left[train], described[test])
    sealed = np.flatnonzero(found.sealed)
    mean[sealed], deviation[sealed] = _predicted(described[opened], left[opened], described[sealed])
    errors = np.expm1(mean - left)
    scaled = np.abs(left - mean) / deviation
    width = np.full(len(left), np.quantile(scaled[opened], _CONFIDENCE))
    for fold in range(_FOLDS):
        width[opened[folds == fold]] = np.quantile(scaled[opened[folds != fold]], _CONFIDENCE)
    inside = scaled <= width
    return Discrepancy(
        correction,
        Errors.of(errors[opened]),
        float(np.mean(inside[opened])),
        Errors.of(errors[sealed]),
        float(np.mean(inside[sealed])),
    )


def _described(found: Estimates, correction: str) -> Array:
    """Returns the features of a set-up: logarithms of the other corrections' estimates over this one, and its size."""
    own = found.by_correction[correction]
    others = ("none", "arc", "kirchhoff", "reciprocity", "two-sided-arc")
    columns = [np.log(np.maximum(found.by_correction[other] / own, 1e-3)) for other in others]
    return np.column_stack([*columns, np.log(own)])


def _predicted(train: Array, values: Array, test: Array) -> tuple[Array, NDArray[np.float64]]:
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

    centre, scale = train.mean(axis=0), train.std(axis=0)
    size = float(values.std())
    # In units of the standardised features and of the values' standard deviation.
    kernel = ConstantKernel(0.5, (1e-3, 10)) * RBF(np.full(train.shape[1], 2.0), (0.2, 100)) + WhiteKernel(
        0.5, (1e-3, 2)
    )
    process = GaussianProcessRegressor(kernel, normalize_y=False, random_state=_SEED)
    with warnings.catch_warnings():
        # A length scale at its upper limit means that its feature does not matter.
        warnings.simplefilter("ignore", ConvergenceWarning)
        process.fit((train - centre) / scale, values / size)
    mean, deviation = process.predict((test - centre) / scale, return_std=True)
    return np.asarray(mean * size), np.asarray(deviation * size)
