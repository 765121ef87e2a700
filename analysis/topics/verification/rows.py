"""Solves one row of the verification in a process of its own: python3 -m analysis.topics.verification.rows ROW prints JSON.

A row is `truth/CASE` or `cost/CASE/METHOD`.
"""

from __future__ import annotations

import argparse
import itertools
import json
import logging
import sys
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.topics.verification.set_ups import CostCase, Quantity, TrueCase, cost_cases, true_cases
from fem_reference.solve.level import Level
from fem_reference.common.limits import Limits
from fem_reference.answer.reference import ErrorKind, Reference, solve_conductors

Array = NDArray[np.float64]
Document = dict[str, Any]
TRUTH_RTOL = 1e-3
"""The accuracy that the reference aims at by default."""
METHODS = ESTIMATE, TIGHT, ENCLOSURE = "estimate", "tight", "enclosure"
MAX_SECONDS = {ESTIMATE: 60.0, TIGHT: 60.0, ENCLOSURE: 20.0}
"""Time limit (s) of a row; the targets go up to 60 s."""
ENCLOSURE_RTOL = 5e-4


def row_names() -> list[str]:
    """Returns the names of all rows, grouped by kind."""
    names = [f"truth/{name}" for name in true_cases()]
    for case in cost_cases().values():
        methods = [method for method in METHODS if method != TIGHT or len(case.targets) > 1]
        names += [f"cost/{case.name}/{method}" for method in methods]
    return names


def solve_row(name: str) -> Document:
    """Computes the document of one row; KeyError for an unknown one."""
    kind, _, rest = name.partition("/")
    if kind == "truth":
        return _truth(true_cases()[rest])
    case, _, method = rest.partition("/")
    return _cost(cost_cases()[case], method)


def _truth(case: TrueCase) -> Document:
    found = [
        solve_conductors(set_up.conductors(), rtol=TRUTH_RTOL, error=case.error)
        for set_up in (case.set_up, *case.longer)
    ]
    quantities = [
        _per_length(quantity, found, case.length) if case.longer else _compared(quantity, found[0])
        for quantity in case.quantities
    ]
    return {
        "kind": case.error,
        "source": case.source,
        "seconds": sum(answer.seconds for answer in found),
        "unknowns": max(level.unknowns for answer in found for level in answer.levels),
        "edge_sizes": [level.edge_size for level in found[0].levels],
        "curved": bool(found[0].curved),
        "quantities": quantities,
    }


def _compared(quantity: Quantity, found: Reference) -> Document:
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
    parts = [_compared(quantity, answer) for answer in found]
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


def _cost(case: CostCase, method: str) -> Document:
    problem, seconds = case.set_up.conductors(), MAX_SECONDS[method]
    rtol = {ESTIMATE: case.targets[0][0], TIGHT: case.targets[-1][0], ENCLOSURE: ENCLOSURE_RTOL}[method]
    points: list[Document] = []
    spent = 0.0

    def note(answer: Reference) -> None:
        nonlocal spent
        spent += answer.levels[-1].seconds
        points.append(_point(answer.levels[-1], spent, answer.worst))

    # With a time limit every level is enclosed, and each is a point of the table.
    error: ErrorKind = "enclosure" if method == ENCLOSURE else "estimate"
    found = solve_conductors(problem, rtol=rtol, error=error, limits=Limits(seconds=seconds), progress=note)
    return {
        "points": points,
        "rtol": rtol,
        "reached": found.reached,
        "stated": found.worst,
        "seconds": found.seconds,
        "memory": found.levels[-1].memory,
        "value": found.maxwell.value.tolist(),
        "error": found.maxwell.error.tolist(),
    }


def _point(level: Level, spent: float, worst: float) -> Document:
    """Returns a level: `seconds` from the start on, `stated` the largest relative error of the answer so far."""
    point = {"unknowns": level.unknowns, "seconds": spent, "maxwell": level.maxwell.tolist(), "stated": worst}
    if level.enclosure is not None:
        point |= {"lower": level.enclosure.lower.tolist(), "upper": level.enclosure.upper.tolist()}
    return point


def main() -> int:
    parser = argparse.ArgumentParser(prog="python3 -m analysis.topics.verification.rows", description=__doc__)
    parser.add_argument("row", metavar="ROW", choices=row_names())
    logging.getLogger().setLevel(logging.WARNING)
    print(json.dumps(solve_row(parser.parse_args().row)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
