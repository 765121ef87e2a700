"""Pairs of set-ups whose answers must agree: congruent ones, and those with sensor and target exchanged."""

import itertools
from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import pdist, squareform

from analysis.results.answers import Estimate, MatrixAnswer
from analysis.results.set_up import Rectangle, rectangles
from analysis.results.study_results import CaseResult
from geometries.common.arrays import Array

# Relative tolerance for equal lengths, of the set-up's size: more than rounding, less than any intended difference.
_TOLERANCE = 1e-9
# Of both rectangles.
_CORNERS = 8
# The ways to walk around a rectangle, from any corner in either direction.
_WALKS = [np.roll(order, shift) for order in ([0, 1, 2, 3], [3, 2, 1, 0]) for shift in range(4)]


@dataclass(frozen=True)
class Pair:
    """Two cases that must agree in `quantity`, and what a method says of each; farads."""

    first: CaseResult
    second: CaseResult
    relation: str
    quantity: str
    method: str
    first_value: Estimate
    second_value: Estimate

    @property
    def agrees(self) -> bool:
        return self.first_value.agrees_with(self.second_value)

    @property
    def difference(self) -> float:
        """Relative to the mean of the two."""
        mean = (self.first_value.value + self.second_value.value) / 2
        return abs(self.first_value.value - self.second_value.value) / mean


def pairs(cases: list[CaseResult]) -> list[Pair]:
    """Returns every pair of cases with answers that must agree, by each method that has solved both: congruent set-ups in both
    quantities, exchanged ones in `mutual`."""
    solved = [(case, plates) for case in cases if case.truth and (plates := rectangles(case.scene))]
    found = []
    for one, other in _alike([plates for _, plates in solved]):
        (first, here), (second, there) = solved[one], solved[other]
        if _congruent(here, there):
            for name in ("mutual", "delta_self"):
                found += _pairs(first, second, "mirrored or moved", name)
        elif _congruent(here, (there[1], there[0])):
            found += _pairs(first, second, "sensor and target exchanged", "mutual")
    return found


def _alike(set_ups: list[tuple[Rectangle, Rectangle]]) -> list[tuple[int, int]]:
    """Returns the candidates, as pairs of indices in order: set-ups whose distances between all corners have the same sum. Few have,
    and only these need the exact comparison."""
    sums = np.array([_distances(sensor.vertices, target.vertices).sum() for sensor, target in set_ups])
    order = np.argsort(sums, kind="stable")
    # A single distance is smaller than the sum of all, and so is its rounding error.
    ends = np.searchsorted(sums[order], sums[order] * (1 + _CORNERS**2 * _TOLERANCE), side="right")
    pairs = ((int(one), int(other)) for at, one in enumerate(order) for other in order[at + 1 : ends[at]])
    return sorted((min(pair), max(pair)) for pair in pairs)


def _congruent(first: tuple[Rectangle, Rectangle], second: tuple[Rectangle, Rectangle]) -> bool:
    """Tells whether a motion or a mirror image takes one set-up to the other, sensor to sensor. It does when
    the distances between all the corners are the same, in some order around each rectangle."""
    distances = _distances(first[0].vertices, first[1].vertices)
    sensor, target = (plate.vertices for plate in second)
    walked = (_distances(sensor[own], target[other]) for own, other in itertools.product(_WALKS, repeat=2))
    tolerance = _TOLERANCE * distances.max()
    return any((np.abs(each - distances) <= tolerance).all() for each in walked)


def _distances(sensor: Array, target: Array) -> Array:
    return np.asarray(squareform(pdist(np.concatenate([sensor, target]))))


def _pairs(first: CaseResult, second: CaseResult, relation: str, quantity: str) -> list[Pair]:
    assert first.truth is not None and second.truth is not None
    both = first.truth.answers, second.truth.answers
    return [
        Pair(first, second, relation, quantity, method, *(_value(each[method], quantity) for each in both))
        for method in both[0]
        if method in both[1]
    ]


def _value(answer: MatrixAnswer, quantity: str) -> Estimate:
    sensor, target = answer.conductors
    return answer.mutual(sensor, target) if quantity == "mutual" else answer.delta_self[sensor]
