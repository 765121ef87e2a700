"""Compares every value that both methods compute, and the intervals that both prove for the diagonal of the Maxwell matrix."""

from __future__ import annotations

from dataclasses import dataclass

from analysis.results.answers import BoundaryAnswer, Estimate, ReferenceAnswer
from analysis.results.set_up import is_delta_self
from analysis.results.study_results import CaseResult, Results

QUADRATURE_SHARE = 0.05
"""Largest quadrature error of an entry that is called a lower bound, relative to its stated error (model/BOUNDARY_ELEMENTS.md,
section 6)."""


@dataclass(frozen=True)
class Comparison:
    """One value of a case; farads. The field solver's is known to lie from `low` to `high`."""

    case: CaseResult
    what: str
    reference: float
    low: float
    high: float
    boundary: Estimate

    @property
    def difference(self) -> float:
        """The difference relative to the field solver's value."""
        return (self.boundary.value - self.reference) / abs(self.reference)

    @property
    def allowed(self) -> float:
        """The sum of both errors, relative to the field solver's value."""
        towards = (self.high - self.reference) if self.difference > 0 else (self.reference - self.low)
        return (towards + self.boundary.error) / abs(self.reference)

    @property
    def over_errors(self) -> float:
        """The difference over what both errors allow: above 1 the error bars do not overlap."""
        return abs(self.difference) / self.allowed if self.allowed > 0 else float("inf")

    @property
    def agrees(self) -> bool:
        return self.over_errors <= 1


@dataclass(frozen=True)
class Bracket:
    """A diagonal entry of the Maxwell matrix between bounds (F): `lower` is Galerkin's, `flux` and `upper` are the field solver's."""

    case: CaseResult
    conductor: str
    lower: float
    flux: float
    upper: float

    @property
    def width(self) -> float:
        """The width from the better lower bound to the upper bound, relative to the latter."""
        return (self.upper - max(self.lower, self.flux)) / self.upper

    @property
    def width_before(self) -> float:
        """The same without boundary elements."""
        return (self.upper - self.flux) / self.upper


def comparisons(results: Results) -> list[Comparison]:
    """Returns the entries on and above the diagonal, delta_self and the changes of readings of every case that both have solved, the worst
    first."""
    found = []
    for case in results.cases.values():
        if case.reference is not None and case.boundary is not None:
            found += _of_case(case, case.reference, case.boundary)
    return sorted(found, key=lambda comparison: -comparison.over_errors)


def disagreements(found: list[Comparison]) -> list[Comparison]:
    """Returns the comparisons whose error bars do not overlap: one of the two values, or its error, is wrong."""
    return [comparison for comparison in found if not comparison.agrees]


def contradictions(results: Results) -> int:
    """Counts the values that disagree and the diagonal entries whose lower bound is above the upper one."""
    empty = sum(bracket.width < 0 for bracket in brackets(results))
    return len(disagreements(comparisons(results))) + empty


def brackets(results: Results) -> list[Bracket]:
    """Returns the bracket of every diagonal entry that the field solver encloses and boundary elements bound from below."""
    found = []
    for case in results.cases.values():
        reference, boundary = case.reference, case.boundary
        if reference is None or boundary is None or not reference.is_proven:
            continue
        for name in reference.conductors:
            place = reference.conductors.index(name)
            lower = _lower_bound(boundary, name)
            if lower is not None:
                flux, upper = float(reference.lower[place, place]), float(reference.upper[place, place])
                found.append(Bracket(case, name, lower, flux, upper))
    return found


def _lower_bound(boundary: BoundaryAnswer, name: str) -> float | None:
    if name not in boundary.conductors:
        return None
    place = boundary.conductors.index(name)
    if not boundary.lower_bounds[place]:
        return None
    return float(boundary.maxwell[place, place] - QUADRATURE_SHARE * boundary.error[place, place])


def _of_case(case: CaseResult, reference: ReferenceAnswer, boundary: BoundaryAnswer) -> list[Comparison]:
    common = [name for name in reference.conductors if name in boundary.conductors]
    found = []
    for number, first in enumerate(common):
        for second in common[number:]:
            here = reference.conductors.index(first), reference.conductors.index(second)
            there = boundary.conductors.index(first), boundary.conductors.index(second)
            found.append(
                Comparison(
                    case,
                    f"M[{first}, {second}]",
                    float(reference.maxwell[here]),
                    float(reference.lower[here]),
                    float(reference.upper[here]),
                    Estimate(float(boundary.maxwell[there]), float(boundary.error[there])),
                )
            )
    felt = {f"delta_self {sensor}": change for sensor, change in reference.delta_self.items()}
    also = {f"delta_self {sensor}": change for sensor, change in boundary.delta_self.items()}
    # Elsewhere the changes are delta_self once more.
    if not is_delta_self(case.scene):
        felt |= {f"change {name}": reading.change for name, reading in reference.readings.items()}
        also |= {f"change {name}": reading.change for name, reading in boundary.readings.items()}
    for what, change in felt.items():
        if what in also:
            low, high = change.value - change.error, change.value + change.error
            found.append(Comparison(case, what, change.value, low, high, also[what]))
    return found
