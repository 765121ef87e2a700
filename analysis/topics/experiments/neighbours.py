"""Experiment V: the interaction of two adjacent sensors and an object near one of them, from the answers of a study."""

from __future__ import annotations

from dataclasses import dataclass

from analysis.results.answers import Estimate
from analysis.results.study_results import CaseResult, Results
from analysis.results.truth import Truth
from analysis.results.commands import COMPARED_METHOD

FAMILY, ALONE = "sensors", "parallel"
NEAR, NEIGHBOUR = "sensor", "neighbour"


@dataclass(frozen=True)
class Felt:
    """The effect of the object on one sensor: delta_self and mutual by the reference, and the model's value (F)."""

    delta_self: Estimate
    mutual: Estimate
    model: float


@dataclass(frozen=True)
class Point:
    """One set-up at a gap (m). `coupling` is −M between the sensors, `coupling_alone` the same without the object;
    `single` is the near sensor's delta_self without the neighbour, None if the study does not contain it (F).
    """

    case: str
    gap: float
    near: Felt
    neighbour: Felt
    coupling: Estimate
    coupling_alone: Estimate
    single: Estimate | None


@dataclass(frozen=True)
class Series:
    """The set-ups of one distance between the sensors (m), by gap."""

    separation: float
    points: tuple[Point, ...]


def series(results: Results) -> list[Series]:
    """Returns a series for each distance between the sensors; set-ups without both answers are left out."""
    found: dict[float, list[Point]] = {}
    for case in results.compared():
        point = _point(results, case) if case.family == FAMILY else None
        if point is not None:
            found.setdefault(_number(case, "separation"), []).append(point)
    return [
        Series(separation, tuple(sorted(points, key=lambda point: point.gap)))
        for separation, points in found.items()
    ]


def _point(results: Results, case: CaseResult) -> Point | None:
    empty = results.cases.get(case.empty)
    if case.truth is None or case.model is None or empty is None or empty.truth is None:
        return None
    target = case.scene.objects[0].name
    values = case.model.values[COMPARED_METHOD]
    near, neighbour = (
        Felt(
            case.truth.delta_self(name).best,
            case.truth.mutual(name, target).best,
            values[name].objects[target],
        )
        for name in (NEAR, NEIGHBOUR)
    )
    return Point(
        case=case.id,
        gap=_number(case, "gap"),
        near=near,
        neighbour=neighbour,
        coupling=_coupling(case.truth),
        coupling_alone=_coupling(empty.truth),
        single=_single(results, case),
    )


def _coupling(truth: Truth) -> Estimate:
    return truth.mutual(NEAR, NEIGHBOUR).best


def _single(results: Results, case: CaseResult) -> Estimate | None:
    """Finds delta_self of the same set-up without the neighbour."""
    same = ("sensor_size", "target_size", "gap", "offset")
    for other in results.compared():
        alike = all(other.parameters.get(name) == case.parameters[name] for name in same)
        if other.family == ALONE and alike and other.truth is not None:
            return other.truth.delta_self(NEAR).best
    return None


def _number(case: CaseResult, name: str) -> float:
    value = case.parameters[name]
    assert isinstance(value, float)
    return value
