"""Experiment VI: the same target of other materials, from the answers of a study to its report."""

from dataclasses import dataclass

from markupsafe import Markup

from analysis.report import page
from analysis.report.plot import INK, Panel, axis, figure, joined, log_axis, power_axis, series_colour
from analysis.results.answers import Estimate
from analysis.results.statistics import grouped
from analysis.results.study_results import COMPARED_METHOD, CaseResult, Results
from analysis.results.units import CENTIMETRE
from analysis.topics.experiments.curves import DISTANCE, estimated, number, place
from geometries.common.measured import PICOFARAD
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
    known = (case for case in results.compared() if case.family == _FAMILY and case.truth is not None)
    return [
        Material(*material, tuple(sorted(map(_point, cases), key=lambda point: point.gap)))
        for material, cases in grouped(known, _material).items()
    ]


def ratios(material: Material, grounded: Material) -> list[tuple[Point, float]]:
    """Returns delta_self relative to that of the grounded target at the same gap."""
    there = {point.gap: point.delta_self.value for point in grounded.points}
    points = (point for point in material.points if point.gap in there)
    return [(point, point.delta_self.value / there[point.gap]) for point in points]


def _material(case: CaseResult) -> tuple[str, float | None]:
    name, permittivity = case.parameters["material"], case.parameters["relative_permittivity"]
    assert isinstance(name, str) and isinstance(permittivity, float)
    return name, permittivity if name == DIELECTRIC else None


def _point(case: CaseResult) -> Point:
    assert case.truth is not None
    sensor = case.scene.sensors[0].name
    model = None if case.model is None else case.model.values[COMPARED_METHOD][sensor].total
    return Point(case.id, number(case, DISTANCE), case.truth.delta_self(sensor).best, model)


_WHAT = (
    "Floating: a conductor without total charge, which is also the limit of a large permittivity. The model applies to grounded conductors "
    "only: its line is that of the grounded target. mutual exists only for the grounded target, so all values are delta_self."
)


def parts(results: Results) -> list[Markup]:
    """Returns the findings, delta_self over the gap by material, its ratio to the grounded target, and every number."""
    found = materials(results)
    grounded = next((each for each in found if each.is_grounded), None)
    if grounded is None:
        return [page.paragraph("No grounded target has an answer to compare the others with.")]
    others = [each for each in found if ratios(each, grounded) and not each.is_grounded]
    return [
        page.finding(finding(grounded, others)),
        page.figures([_felt(found, grounded), _ratios(others, grounded)]),
        page.finding(model_finding(grounded, others)),
        page.folded("Show the numbers", _table(found, grounded)),
        page.soft(_WHAT),
    ]


def finding(grounded: Material, others: list[Material]) -> str:
    """Tells each material's delta_self relative to the grounded target's, near and far."""
    if not others:
        return "There is no other material."
    phrases = []
    for each in others:
        found = ratios(each, grounded)
        ends = [f"{100 * share:.2g} % at {place(at.gap, DISTANCE)}" for at, share in (found[0], found[-1])]
        phrases.append(f"{each.label}: {', '.join(ends)}")
    return f"Of what the grounded target gives in delta_self: {'; '.join(phrases)}."


def model_finding(grounded: Material, others: list[Material]) -> str:
    """Tells the model's value relative to each material's delta_self; the model takes all targets for grounded."""
    model = {point.gap: point.model for point in grounded.points if point.model is not None}
    phrases = []
    for each in [grounded, *others]:
        times = [model[point.gap] / point.delta_self.value for point in each.points if point.gap in model]
        if times:
            phrases.append(f"{each.label} {_factor(min(times))} to {_factor(max(times))} times")
    if not phrases:
        return "The model has no answer."
    return f"The model takes every target for grounded; over delta_self it is: {'; '.join(phrases)}."


def _factor(value: float) -> str:
    return f"{value:.0f}" if value >= 10 else f"{value:.2g}"


def _felt(found: list[Material], grounded: Material) -> Panel:
    traces, hover = [], "%{y:.4g} pF at %{x:.3g} cm"
    for index, each in enumerate(found):
        gaps, cases = [point.gap / CENTIMETRE for point in each.points], [point.case for point in each.points]
        felt = [point.delta_self for point in each.points]
        traces.append(estimated(each.label, gaps, felt, series_colour(index), hover, customdata=cases))
    known = [point for point in grounded.points if point.model is not None]
    gaps = [point.gap / CENTIMETRE for point in known]
    model = [(point.model or 0.0) / PICOFARAD for point in known]
    traces.append(joined("model", gaps, model, INK, "%{y:.4g} pF", mode="lines", dash="dash"))
    y = power_axis("delta_self (pF)")
    return Panel("delta_self over the gap", figure(traces, log_axis("gap (cm)"), y, 440))


def _ratios(others: list[Material], grounded: Material) -> Panel:
    traces = []
    for index, each in enumerate(others, 1):
        found = ratios(each, grounded)
        gaps, shares = [point.gap / CENTIMETRE for point, _ in found], [100 * ratio for _, ratio in found]
        cases = [point.case for point, _ in found]
        traces.append(joined(each.label, gaps, shares, series_colour(index), "%{y:.3g} %", customdata=cases))
    y = axis("part of the grounded target's (%)", rangemode="tozero")
    return Panel("the same over that of the grounded target", figure(traces, log_axis("gap (cm)"), y, 440))


def _table(found: list[Material], grounded: Material) -> Markup:
    return page.table_of(
        [(each, *pair) for each in found for pair in ratios(each, grounded)],
        ("material", lambda row: row[0].label),
        ("gap", lambda row: page.case_link(row[1].case, place(row[1].gap, DISTANCE))),
        ("delta_self (pF)", lambda row: row[1].delta_self.in_picofarads),
        ("of grounded", lambda row: f"{100 * row[2]:.2f} %"),
        ("model (pF)", lambda row: "" if row[1].model is None else f"{row[1].model / PICOFARAD:.5f}"),
        text_columns=2,
    )
