"""Errors of the methods over all set-ups: by family and over the sealed third."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analysis.topics.corrections.estimates import Errors, Estimates


@dataclass(frozen=True)
class Evaluation:
    """One method. `open_`: two thirds of the set-ups, on which constants were fitted; `sealed`: the others."""

    name: str
    all: Errors
    open_: Errors
    sealed: Errors
    families: dict[str, Errors]


def evaluations(found: Estimates) -> tuple[Evaluation, ...]:
    """Returns the errors of all methods, whose estimates are given."""
    return tuple(_evaluation(found, name) for name in found.by_method)


def _evaluation(found: Estimates, name: str) -> Evaluation:
    errors, families = found.errors(name), np.array(found.families)
    return Evaluation(
        name,
        Errors.of(errors),
        Errors.of(errors[~found.sealed]),
        Errors.of(errors[found.sealed]),
        {family: Errors.of(errors[families == family]) for family in dict.fromkeys(found.families)},
    )
