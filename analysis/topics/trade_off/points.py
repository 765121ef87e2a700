"""Run times and errors of all methods, over the set-ups that all of them solved, as points of one plot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.results.store import Document
from analysis.results.study_results import CaseResult, Results

Array = NDArray[np.float64]

MESH = "field solver, one mesh"
ANSWER = "field solver, whole answer"
# Least fraction of the set-ups that must have a mesh level for it to be a point.
_LEAST_SHARE = 0.5


@dataclass(frozen=True)
class Point:
    """A method over the set-ups: the median of the seconds for one pose, and of the errors in `mutual` relative to the truth, with
    the error that 95 % of the set-ups stay below; `worst` is the case with the largest."""

    kind: str
    name: str
    seconds: float
    error: float
    percentile_95: float
    worst: str


def points(document: Document, results: Results) -> list[Point]:
    """Returns the measured methods, then the field solver's stored meshes and answers."""
    truths = {case: truth["mutual"] for case, truth in document["truths"].items()}
    found = [
        _point(
            entry["kind"],
            entry["name"],
            [entry["seconds"][case] for case in truths],
            {case: entry["values"][case] / truth - 1 for case, truth in truths.items()},
        )
        for entry in document["methods"]
    ]
    solved = [(results.cases[case], truth) for case, truth in truths.items() if _is_solved(results, case)]
    return [*found, *_meshes(solved), *_answers(solved)]


def known_to(document: Document) -> float:
    """Returns the median relative error of the truths; errors below it cannot be distinguished."""
    return float(np.median([truth["error"] / truth["mutual"] for truth in document["truths"].values()]))


def agreement(document: Document, results: Results) -> tuple[int, int]:
    """Returns how many truths lie within the field solver's error and their own, and how many it has solved."""
    agreeing = total = 0
    for case, truth in document["truths"].items():
        if _is_solved(results, case):
            reference = results.cases[case].reference
            assert reference is not None
            value = reference.mutual(*reference.conductors)
            total += 1
            agreeing += abs(value.value - truth["mutual"]) <= value.error + truth["error"]
    return agreeing, total


def _is_solved(results: Results, case: str) -> bool:
    return case in results.cases and results.cases[case].reference is not None


def _meshes(solved: list[tuple[CaseResult, float]]) -> list[Point]:
    found = []
    levels = [(case.id, case.reference.levels, truth) for case, truth in solved if case.reference is not None]
    for depth in range(max((len(each) for _, each, _ in levels), default=0)):
        there = [(case, each[depth], truth) for case, each, truth in levels if len(each) > depth]
        if len(there) >= _LEAST_SHARE * len(levels):
            errors = {case: -level.maxwell[0, 1] / truth - 1 for case, level, truth in there}
            found.append(_point(MESH, f"{depth + 1}", [level.seconds for _, level, _ in there], errors))
    return found


def _answers(solved: list[tuple[CaseResult, float]]) -> list[Point]:
    pairs = [(case.id, case.reference, truth) for case, truth in solved if case.reference is not None]
    if not pairs:
        return []
    errors = {case: -answer.maxwell[0, 1] / truth - 1 for case, answer, truth in pairs}
    return [_point(ANSWER, "answer", [answer.seconds for _, answer, _ in pairs], errors)]


def _point(kind: str, name: str, seconds: list[float], errors: dict[str, float]) -> Point:
    """Makes a point of a method; `errors` are by case."""
    size = np.abs(list(errors.values()))
    return Point(
        kind,
        name,
        float(np.median(seconds)),
        float(np.median(size)),
        float(np.quantile(size, 0.95)),
        max(errors, key=lambda case: abs(errors[case])),
    )
