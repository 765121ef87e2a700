"""The methods' estimates of all set-ups with their errors, and the tables of errors in model/CORRECTIONS.md: `python3 -m analysis measure corrections`."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from analysis.pipeline.model_stage import model_module, options
from analysis.results.units import percent
from analysis.topics.corrections.set_ups import SetUp, Truth, load, set_ups
from geometries.common.arrays import Array
from geometries.common.installation import ROOT

PLAIN, FORMULA, REDUCED = "exact", "formula", "reduced"
METHODS = (PLAIN, FORMULA, REDUCED)
"""The plain model, and what comes closer."""


@dataclass(frozen=True, eq=False)
class Estimates:
    """Set-ups with their truths, and each method's estimates (n,) of `mutual` (F) by its name."""

    set_ups: tuple[SetUp, ...]
    truths: tuple[Truth, ...]
    by_method: dict[str, Array]

    def errors(self, method: str, chosen: Callable[[SetUp], bool] = lambda _: True) -> Array:
        """Returns (estimate − truth)/truth of the set-ups that are chosen."""
        truth = np.array([each.mutual for each in self.truths])
        kept = [index for index, each in enumerate(self.set_ups) if chosen(each)]
        return np.asarray((self.by_method[method] / truth - 1)[kept])


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


def estimate(module: Any) -> Estimates:
    """Asks every method for all set-ups."""
    asked, truths = tuple(set_ups(module)), load()
    if lacking := [each.name for each in asked if each.name not in truths]:
        again = "python3 -m analysis measure truths corrections makes them anew"
        raise KeyError(f"{lacking[0]} has no truth: {again}")
    values: dict[str, list[float]] = {method: [] for method in METHODS}
    for set_up in asked:
        scene = module.Scene.loads(set_up.text)
        for method in METHODS:
            values[method].append(scene.capacitance(**options(method))["sensors"][0]["total"])
    by_method = {method: np.array(numbers) for method, numbers in values.items()}
    return Estimates(asked, tuple(truths[each.name] for each in asked), by_method)


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
    return Evaluation(
        name,
        Errors.of(found.errors(name)),
        Errors.of(found.errors(name, lambda each: each.sealed)),
        {
            family: Errors.of(found.errors(name, lambda each: each.family == family))
            for family in dict.fromkeys(each.family for each in found.set_ups)
        },
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


def near_misses(found: Estimates) -> int:
    """Counts the set-ups in which the reduced method is off by more than 1 %."""
    return int(np.sum(np.abs(found.errors(REDUCED)) > 0.01))


def measure(_: argparse.Namespace) -> int:
    """Prints all lines; takes some seconds."""
    found = estimate(model_module())
    evaluated = evaluations(found)
    near = f"{near_misses(found)} of {len(found.set_ups)} set-ups are more than 1 % off by reduced"
    print("\n".join([*errors_table(evaluated), near, by_family(evaluated)]))
    return 0
