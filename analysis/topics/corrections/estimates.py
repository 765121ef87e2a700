"""The methods' estimates of all set-ups with their errors, and the tables of errors in model/CORRECTIONS.md: `python3 -m analysis measure corrections`."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.pipeline.model_stage import model_module, options
from analysis.results.units import percent
from analysis.topics.corrections.set_ups import SetUp, Truth, load, set_ups
from geometries.common.installation import ROOT

Array = NDArray[np.float64]
PLAIN, FORMULA, REDUCED = "exact", "formula", "reduced"
METHODS = (PLAIN, FORMULA, REDUCED)
"""The plain model, and what comes closer."""


@dataclass(frozen=True, eq=False)
class Estimates:
    """`mutual` in farads: the truth of each set-up (n,), and each method's estimates (n,) by its name."""

    names: tuple[str, ...]
    families: tuple[str, ...]
    sealed: NDArray[np.bool_]
    truth: Array
    by_method: dict[str, Array]

    def errors(self, method: str) -> Array:
        """Returns (estimate − truth)/truth."""
        return np.asarray(self.by_method[method] / self.truth - 1)


@dataclass(frozen=True)
class Errors:
    """Statistics of the relative errors over some set-ups."""

    count: int
    rms: float
    median: float
    percentile_95: float
    worst: float

    @staticmethod
    def of(errors: Array) -> Errors:
        size = np.abs(errors)
        return Errors(
            len(errors),
            float(np.sqrt(np.mean(errors**2))),
            float(np.median(size)),
            float(np.quantile(size, 0.95)),
            float(np.max(size)),
        )


def estimate(module: Any, chosen: Sequence[SetUp] | None = None) -> Estimates:
    """Asks every method for the set-ups, all of them if none are given."""
    truths = load()
    asked = list(set_ups(module)) if chosen is None else list(chosen)
    values: dict[str, list[float]] = {method: [] for method in METHODS}
    for set_up in asked:
        scene = module.Scene.loads(set_up.text)
        for method in METHODS:
            values[method].append(scene.capacitance(**options(method))["sensors"][0]["total"])
    return Estimates(
        tuple(set_up.name for set_up in asked),
        tuple(set_up.family for set_up in asked),
        np.array([set_up.sealed for set_up in asked]),
        np.array([_truth(truths, set_up).mutual for set_up in asked]),
        {method: np.array(numbers) for method, numbers in values.items()},
    )


def _truth(truths: dict[str, Truth], set_up: SetUp) -> Truth:
    if set_up.name not in truths:
        raise KeyError(
            f"{set_up.name} has no truth: python3 -m analysis measure truths corrections makes them anew"
        )
    return truths[set_up.name]


@dataclass(frozen=True)
class Evaluation:
    """One method. `sealed`: over the third of the set-ups on which no constant was fitted."""

    name: str
    all: Errors
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
        Errors.of(errors[found.sealed]),
        {family: Errors.of(errors[families == family]) for family in dict.fromkeys(found.families)},
    )


PAGE = ROOT / "model" / "CORRECTIONS.md"
_HEADER = ("| | rms | median | 95 % | worst | sealed rms / worst |", "|---|---|---|---|---|---|")


def errors_table(found: Sequence[Evaluation]) -> list[str]:
    """Returns a row for each method, per cent of the truth."""
    return [*_HEADER, *(_row(each) for each in found)]


def by_family(found: Sequence[Evaluation]) -> str:
    """Returns the formula's errors by family."""
    (formula,) = (each for each in found if each.name == FORMULA)
    phrases = (f"{family} {_both(errors)}" for family, errors in formula.families.items())
    return f"The formula by family, rms / worst: {', '.join(phrases)}."


def _row(each: Evaluation) -> str:
    every = each.all
    phrases = (_per_cent(value) for value in (every.rms, every.median, every.percentile_95, every.worst))
    return f"| `{each.name}` | {' | '.join(phrases)} | {_both(each.sealed)} |"


def _both(errors: Errors) -> str:
    return f"{_per_cent(errors.rms)} / {_per_cent(errors.worst)}"


def _per_cent(value: float) -> str:
    """Returns a number for a column in per cent."""
    return percent(value).removesuffix(" %")


def figures(module: Any) -> list[str]:
    """Returns all lines; takes some seconds."""
    chosen = list(set_ups(module))
    asked = estimate(module, chosen)
    found = evaluations(asked)
    return [
        *errors_table(found),
        f"{near_misses(asked)} of {len(chosen)} set-ups are more than 1 % off by reduced",
        by_family(found),
    ]


def near_misses(found: Estimates) -> int:
    """Counts the set-ups in which the reduced method is off by more than 1 %."""
    return int(np.sum(np.abs(found.errors(REDUCED)) > 0.01))


def measure(_: argparse.Namespace) -> int:
    """Prints all lines."""
    print("\n".join(figures(model_module())))
    return 0
