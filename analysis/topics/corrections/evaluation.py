"""Errors of the methods over all set-ups: by family, with fits that left a family out, and over the sealed third."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.topics.corrections import fit
from analysis.topics.corrections.estimates import FORMULA, REDUCED, Array, Errors, Estimates
from analysis.topics.corrections.set_ups import SetUp


@dataclass(frozen=True)
class Evaluation:
    """One method. `open_`: two thirds of the set-ups, on which constants were fitted; `sealed`: the others.

    `left_out`: errors of cross-validation by family, over all families. The constants of the formula, and a factor on
    the plain model, are fitted to the open set-ups of the other families; `reduced` has nothing to fit.
    """

    name: str
    all: Errors
    open_: Errors
    sealed: Errors
    families: dict[str, Errors]
    left_out: Errors


def evaluations(module: Any, found: Estimates, chosen: list[SetUp]) -> tuple[Evaluation, ...]:
    """Returns the errors of all methods in the set-ups, whose estimates are given."""
    families = np.array(found.families)
    left_out = {
        name: _factor_left_out(found.errors(name), families, found.sealed) for name in found.by_method
    }
    left_out[REDUCED] = found.errors(REDUCED)
    left_out[FORMULA] = _formula_left_out(module, chosen, families, found.sealed)
    return tuple(_evaluation(found, name, left_out[name]) for name in found.by_method)


def _evaluation(found: Estimates, name: str, left_out: Array) -> Evaluation:
    errors, families = found.errors(name), np.array(found.families)
    return Evaluation(
        name,
        Errors.of(errors),
        Errors.of(errors[~found.sealed]),
        Errors.of(errors[found.sealed]),
        {family: Errors.of(errors[families == family]) for family in dict.fromkeys(found.families)},
        Errors.of(left_out),
    )


def _factor_left_out(errors: Array, families: NDArray[np.str_], sealed: NDArray[np.bool_]) -> Array:
    """Returns the errors of each family when the others' geometric mean is divided out."""
    result = np.empty_like(errors)
    for family in np.unique(families):
        others = (families != family) & ~sealed
        factor = np.exp(np.mean(np.log1p(errors[others])))
        result[families == family] = (1 + errors[families == family]) / factor - 1
    return result


def _formula_left_out(
    module: Any, chosen: list[SetUp], families: NDArray[np.str_], sealed: NDArray[np.bool_]
) -> Array:
    """Returns the formula's errors in each family with all of its constants fitted to the others."""
    found, truth = fit.terms(module, chosen)
    result = np.empty_like(truth)
    for family in np.unique(families):
        others, own = (families != family) & ~sealed, families == family
        constants = fit.fit(fit.part(found, others), truth[others])
        result[own] = fit.formula(fit.part(found, own), constants) / truth[own] - 1
    return result
