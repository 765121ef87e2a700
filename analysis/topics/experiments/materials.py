"""Experiment VI: the same target of other materials, from the answers of a study."""

from __future__ import annotations

from dataclasses import dataclass

from analysis.results.answers import Estimate
from analysis.results.study_results import CaseResult, Results
from analysis.results.commands import COMPARED_METHOD
from geometries.studies.families import DIELECTRIC, GROUNDED

_FAMILY = "box"


@dataclass(frozen=True)
class Point:
    """The target at a gap (m): delta_self by the reference, and the model's value where it has one (F)."""

    case: str
    gap: float
    delta_self: Estimate
    model: float | None


@dataclass(frozen=True)
class Material:
    """A material with its points by gap; `permittivity` is relative, None for a conductor."""

    name: str
    permittivity: float | None
    points: tuple[Point, ...]

    @property
    def is_grounded(self) -> bool:
        return self.name == GROUNDED

    @property
    def label(self) -> str:
        return self.name if self.permittivity is None else f"{self.name}, ε = {self.permittivity:g}"


def materials(results: Results) -> list[Material]:
    """Returns every material that has answers, in the study's order."""
    found: dict[tuple[str, float | None], list[Point]] = {}
    for case in results.compared():
        if case.family == _FAMILY and case.truth is not None:
            found.setdefault(_material(case), []).append(_point(case))
    return [
        Material(name, permittivity, tuple(sorted(points, key=lambda point: point.gap)))
        for (name, permittivity), points in found.items()
    ]


def ratios(material: Material, grounded: Material) -> list[tuple[Point, float]]:
    """Returns delta_self relative to that of the grounded target at the same gap."""
    there = {point.gap: point.delta_self.value for point in grounded.points}
    return [
        (point, point.delta_self.value / there[point.gap]) for point in material.points if point.gap in there
    ]


def _material(case: CaseResult) -> tuple[str, float | None]:
    name, permittivity = case.parameters["material"], case.parameters["relative_permittivity"]
    assert isinstance(name, str) and isinstance(permittivity, float)
    return name, permittivity if name == DIELECTRIC else None


def _point(case: CaseResult) -> Point:
    assert case.truth is not None
    sensor, gap = case.scene.sensors[0].name, case.parameters["gap"]
    assert isinstance(gap, float)
    model = None if case.model is None else case.model.values[COMPARED_METHOD][sensor].total
    return Point(case.id, gap, case.truth.delta_self(sensor).best, model)
