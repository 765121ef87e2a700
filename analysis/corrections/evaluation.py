"""Errors of the corrections over all set-ups: by family, with fits that left a family out, and over the sealed third."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from analysis.corrections import estimates, gaussian_process
from analysis.corrections.estimates import Array, Errors, Estimates
from analysis.corrections.gaussian_process import Discrepancy


@dataclass(frozen=True)
class Evaluation:
    """One correction. `open_`: two thirds of the set-ups, on which constants were fitted; `sealed`: the others.

    `left_out`: each family with a factor fitted to the open set-ups of the other families, all families together: what
    is systematic in the others would show here.
    """

    name: str
    all: Errors
    open_: Errors
    sealed: Errors
    families: dict[str, Errors]
    left_out: Errors


@dataclass(frozen=True, eq=False)
class Evaluated:
    estimates: Estimates
    evaluations: tuple[Evaluation, ...]
    discrepancy: Discrepancy


def evaluate(module: Any) -> Evaluated:
    """Evaluate the whole registry; half a minute."""
    found = estimates.estimate(module, estimates.names(module))
    evaluations = tuple(_evaluation(found, name) for name in found.by_correction)
    return Evaluated(found, evaluations, gaussian_process.discrepancy(found, "formula"))


def _evaluation(found: Estimates, name: str) -> Evaluation:
    errors, families = found.errors(name), np.array(found.families)
    return Evaluation(
        name,
        Errors.of(errors),
        Errors.of(errors[~found.sealed]),
        Errors.of(errors[found.sealed]),
        {family: Errors.of(errors[families == family]) for family in dict.fromkeys(found.families)},
        Errors.of(_left_out(errors, families, found.sealed)),
    )


def _left_out(errors: Array, families: Array, sealed: Array) -> Array:
    """The errors of each family when the others' geometric mean is divided out."""
    result = np.empty_like(errors)
    for family in np.unique(families):
        others = (families != family) & ~sealed
        factor = np.exp(np.mean(np.log1p(errors[others])))
        result[families == family] = (1 + errors[families == family]) / factor - 1
    return result
