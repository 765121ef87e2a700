"""Solves one row of the verification in a process of its own: python3 -m analysis.topics.verification.rows ROW prints JSON."""

from __future__ import annotations

import argparse
import itertools
import json
import logging
import sys
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from analysis.topics.verification.set_ups import Quantity, TrueCase, true_cases
from fem_reference.answer.reference import Reference, solve_conductors
from geometries.common.arrays import Array

Document = dict[str, Any]
TRUTH_RTOL = 1e-3
"""The accuracy that the reference aims at by default."""


def solve_row(case: TrueCase) -> Document:
    """Computes the document of one row."""
    found = [
        solve_conductors(set_up.conductors(), rtol=TRUTH_RTOL, error=case.error)
        for set_up in (case.set_up, *case.longer)
    ]
    quantities = [
        _per_length(quantity, found, case.length) if case.longer else compared(quantity, found[0])
        for quantity in case.quantities
    ]
    return {
        "kind": case.error,
        "source": case.source,
        "seconds": sum(answer.seconds for answer in found),
        "unknowns": max(level.unknowns for answer in found for level in answer.levels),
        "edge_sizes": [level.edge_size for level in found[0].levels],
        "curved": bool(found[0].problem.curved),
        "quantities": quantities,
    }


def compared(quantity: Quantity, found: Reference) -> Document:
    """Returns the truth, the best value with its stated error, the bounds, and the value of every level."""
    described = {"name": quantity.name, "truth": quantity.truth, "truth_error": quantity.truth_error}
    of = quantity.of
    if of is None:
        return described | {
            "value": float(found.delta_self.value[0]),
            "error": float(found.delta_self.error[0]),
            "levels": [float(level.delta_self[0]) for level in found.levels],
        }
    value, error = found.maxwell.value, found.maxwell.error
    document = described | {
        "value": of(value),
        "error": carried_error(of, value, error),
        "levels": [of(level.maxwell) for level in found.levels],
    }
    if found.enclosure is not None:
        document["lower"], document["upper"] = extremes(of, found.enclosure.lower, found.enclosure.upper)
    return document


def _per_length(quantity: Quantity, found: list[Reference], length: float) -> Document:
    """Computes the quantity per length, from bodies of one, two and three times `length`."""
    parts = [compared(quantity, answer) for answer in found]
    value, change = endless([part["value"] for part in parts], length)
    own = [weight * part["error"] for weight, part in zip((0.5, 2.0, 1.5), parts)]
    return parts[0] | {
        "value": value,
        "error": sum(own) / length + abs(change),
        "levels": [endless(values, length)[0] for values in zip(*(part["levels"] for part in parts))],
    }


def endless(values: Sequence[float], length: float) -> tuple[float, float]:
    """Fits c·L + a + b/L to the values at L, 2L and 3L; returns c and the size of b/L, by which the two ends interact."""
    first, second, third = values
    before, last = (second - first) / length, (third - second) / length
    # Without b the two differences would be equal; b lowers the first by b/2L² and the second by b/6L².
    change = (last - before) / 2
    return last + change, change


def carried_error(of: Callable[[Array], float], value: Array, error: Array) -> float:
    """Propagates the errors of a symmetric matrix' entries through a function, to first order, adding their absolute contributions."""
    total = 0.0
    for i, j in itertools.combinations_with_replacement(range(len(value)), 2):
        step = np.zeros_like(value)
        step[i, j] = step[j, i] = error[i, j]
        total += abs(of(value + step) - of(value - step)) / 2
    return total


def extremes(of: Callable[[Array], float], lower: Array, upper: Array) -> tuple[float, float]:
    """Returns the least and greatest value, over intervals of the entries, of a function monotone in every entry of a symmetric matrix."""
    pairs = list(itertools.combinations_with_replacement(range(len(lower)), 2))
    found = []
    for choice in itertools.product((False, True), repeat=len(pairs)):
        corner = lower.copy()
        for (i, j), above in zip(pairs, choice):
            corner[i, j] = corner[j, i] = upper[i, j] if above else lower[i, j]
        found.append(of(corner))
    return min(found), max(found)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python3 -m analysis.topics.verification.rows", description=__doc__)
    parser.add_argument("row", metavar="ROW", choices=list(true_cases()))
    logging.getLogger().setLevel(logging.WARNING)
    print(json.dumps(solve_row(true_cases()[parser.parse_args().row])))
    return 0


if __name__ == "__main__":
    sys.exit(main())
