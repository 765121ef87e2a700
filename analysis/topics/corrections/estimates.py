"""The methods' estimates of all set-ups with their errors, and the tables of errors in model/CORRECTIONS.md: `python3 -m analysis measure corrections`."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

import numpy as np

from analysis.pipeline.model_stage import model_module, options
from analysis.results.store import Document
from analysis.results.units import percent
from analysis.topics.corrections.set_ups import SetUp, Truth, load, set_ups
from geometries.common.installation import ROOT

PLAIN, FORMULA, REDUCED = "exact", "formula", "reduced"
METHODS = (PLAIN, FORMULA, REDUCED)
"""The plain model, and what comes closer."""


def estimate(module: Any) -> list[Document]:
    """Returns every set-up with its scene, its truth and the estimates of `mutual` by every method, as plain data: farads, metres."""
    truths = load()
    return [_estimated(module, set_up, truths) for set_up in set_ups(module)]


def _estimated(module: Any, set_up: SetUp, truths: dict[str, Truth]) -> Document:
    if set_up.name not in truths:
        again = "python3 -m analysis measure truths corrections makes them anew"
        raise KeyError(f"{set_up.name} has no truth: {again}")
    scene, truth = module.Scene.loads(set_up.text), truths[set_up.name]
    (plate,), bodies = set_up.scene.sensors[0].plates, set_up.scene.conductors()
    points = [bodies[name].reshape(-1, 3) for name in ("sensor", "target")]
    return {
        "name": set_up.name,
        "family": set_up.family,
        "sealed": set_up.sealed,
        "distance": float(module.gjk_distance(*points)[0]),
        "sensor_size": float(np.sqrt(np.linalg.norm(plate.edge_u) * np.linalg.norm(plate.edge_v))),
        "truth": truth.mutual,
        "error": truth.error,
        "estimates": {
            method: float(scene.capacitance(**options(method))["sensors"][0]["total"]) for method in METHODS
        },
        "scene": set_up.text,
    }


def off(case: Document, method: str) -> float:
    """Returns (estimate − truth)/truth."""
    return float(case["estimates"][method] / case["truth"] - 1)


def evaluations(cases: Sequence[Document]) -> list[Document]:
    """Returns the statistics of each method's errors: of all set-ups, of the sealed third, on which no constant was fitted, and of each
    family."""
    families = dict.fromkeys(case["family"] for case in cases)
    return [
        {
            "name": method,
            "all": errors(cases, method),
            "sealed": errors([case for case in cases if case["sealed"]], method),
            "families": {
                family: errors([case for case in cases if case["family"] == family], method)
                for family in families
            },
        }
        for method in METHODS
    ]


def errors(cases: Sequence[Document], method: str) -> Document:
    """Returns the statistics of a method's relative errors over some set-ups."""
    size = np.abs([off(case, method) for case in cases])
    return {
        "count": len(size),
        "rms": float(np.sqrt(np.mean(size**2))),
        "median": float(np.median(size)),
        "percentile_95": float(np.quantile(size, 0.95)),
        "worst": float(np.max(size)),
    }


PAGE = ROOT / "model" / "CORRECTIONS.md"
_HEADER = ("| | rms | median | 95 % | worst | sealed rms / worst |", "|---|---|---|---|---|---|")


def errors_table(found: Sequence[Document]) -> list[str]:
    """Returns a row for each method, per cent of the truth."""
    return [*_HEADER, *(_row(each) for each in found)]


def by_family(found: Sequence[Document]) -> str:
    """Returns the formula's errors by family."""
    (formula,) = (each for each in found if each["name"] == FORMULA)
    phrases = (f"{family} {_both(errors)}" for family, errors in formula["families"].items())
    return f"The formula by family, rms / worst: {', '.join(phrases)}."


def _row(each: Document) -> str:
    phrases = (_per_cent(each["all"][what]) for what in ("rms", "median", "percentile_95", "worst"))
    return f"| `{each['name']}` | {' | '.join(phrases)} | {_both(each['sealed'])} |"


def _both(errors: Document) -> str:
    return f"{_per_cent(errors['rms'])} / {_per_cent(errors['worst'])}"


def _per_cent(value: float) -> str:
    """Returns a number for a column in per cent."""
    return percent(value).removesuffix(" %")


def near_misses(cases: Sequence[Document]) -> int:
    """Counts the set-ups in which the reduced method is off by more than 1 %."""
    return sum(abs(off(case, REDUCED)) > 0.01 for case in cases)


def measure(_: argparse.Namespace) -> int:
    """Prints all lines; takes some seconds."""
    cases = estimate(model_module())
    evaluated = evaluations(cases)
    near = f"{near_misses(cases)} of {len(cases)} set-ups are more than 1 % off by reduced"
    print("\n".join([*errors_table(evaluated), near, by_family(evaluated)]))
    return 0
