"""`python3 -m analysis measure corrections`: prints the numbers of model/CORRECTIONS.md, section 5.

A test compares the page with them. `python3 -m analysis corrections` measures run times.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

import numpy as np

from analysis.pipeline.model_stage import model_module
from analysis.results.units import percent
from analysis.topics.corrections import estimates
from analysis.topics.corrections.estimates import Errors, Evaluation
from analysis.topics.corrections.set_ups import set_ups
from geometries.common.installation import ROOT

PAGE = ROOT / "model" / "CORRECTIONS.md"
_HEADER = (
    "| | rms | median | 95 % | worst | sealed rms / worst |",
    "|---|---|---|---|---|---|",
)


def errors_table(found: Sequence[Evaluation]) -> list[str]:
    """Returns a row for each method, per cent of the truth."""
    return [*_HEADER, *(_row(each) for each in found)]


def by_family(found: Sequence[Evaluation]) -> str:
    """Returns the formula's errors by family."""
    (formula,) = (each for each in found if each.name == estimates.FORMULA)
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
    asked = estimates.estimate(module, chosen)
    found = estimates.evaluations(asked)
    return [
        *errors_table(found),
        f"{near_misses(asked)} of {len(chosen)} set-ups are more than 1 % off by reduced",
        by_family(found),
    ]


def near_misses(found: estimates.Estimates) -> int:
    """Counts the set-ups in which the reduced method is off by more than 1 %."""
    return int(np.sum(np.abs(found.errors(estimates.REDUCED)) > 0.01))


def measure(_: argparse.Namespace) -> int:
    """Prints all lines."""
    print("\n".join(figures(model_module())))
    return 0
