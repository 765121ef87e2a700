"""Two experiments that the thesis has not, from the answers of a study to its report. Experiment V: the interaction of two adjacent sensors and an object near one of them.
Experiment VI: the same target of other materials."""

from __future__ import annotations

from dataclasses import dataclass

from markupsafe import Markup

from analysis.report import page
from analysis.report.plot import INK, Panel, axis, figure, guide, joined, log_axis, power_axis, series_colour
from analysis.results.answers import Estimate
from analysis.results.study_results import COMPARED_METHOD, CaseResult, Results
from analysis.results.units import CENTIMETRE, percent, signed_percent
from analysis.topics.experiments.curves import DISTANCE, estimated, number, place
from geometries.common.measured import PICOFARAD, picofarads
from geometries.studies.families import DIELECTRIC, GROUNDED


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
            found.setdefault(number(case, "separation"), []).append(point)
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
        gap=number(case, "gap"),
        near=near,
        neighbour=neighbour,
        coupling=case.truth.mutual(NEAR, NEIGHBOUR).best,
        coupling_alone=empty.truth.mutual(NEAR, NEIGHBOUR).best,
        single=_single(results, case),
    )


def _single(results: Results, case: CaseResult) -> Estimate | None:
    """Finds delta_self of the same set-up without the neighbour."""
    same = ("sensor_size", "target_size", "gap", "offset")
    for other in results.compared():
        alike = all(other.parameters.get(name) == case.parameters[name] for name in same)
        if other.family == ALONE and alike and other.truth is not None:
            return other.truth.delta_self(NEAR).best
    return None


_WHAT = (
    "The object lies in front of the sensor at the origin, the other sensor is its neighbour; each is at its own voltage in "
    "turn, the rest is grounded. delta_self: the rise of a sensor's own capacitance by the object, with the neighbour present in "
    "both cases. mutual: charge on the object per volt on a sensor. Coupling: charge on one sensor per volt on the other. "
    "The model sums over the object for each sensor by itself, so it has no coupling, and the neighbour has no effect on it."
)


def parts(found: list[Series]) -> list[Markup]:
    """Returns the finding, the output of each sensor over the gap, the coupling between them, and every number."""
    if not found:
        return [page.paragraph("No set-up of two sensors has both answers.")]
    return [
        page.finding(finding(found)),
        page.figures([_felt(series) for series in found]),
        page.finding(coupling_finding(found)),
        page.figures([_coupling(found)]),
        page.folded("Show the numbers", _table(found)),
        page.soft(_WHAT),
    ]


def finding(found: list[Series]) -> str:
    """Tells how strongly an object affects the sensor that it is not in front of, by reference and model."""
    phrases = []
    for series in found:
        shares = [point.neighbour.delta_self.value / point.near.delta_self.value for point in series.points]
        model = [point.neighbour.model / point.near.model for point in series.points]
        phrases.append(
            f"{_far(series.separation)} away it feels {percent(shares[0])} of what the near sensor does with the object at "
            f"{_far(series.points[0].gap)}, {percent(shares[-1])} at {_far(series.points[-1].gap)} (model: "
            f"{percent(model[0])} and {percent(model[-1])})"
        )
    return f"The neighbour, in delta_self: {'; '.join(phrases)}."


def coupling_finding(found: list[Series]) -> str:
    """Tells how the object shields the sensors from each other, and how the neighbour lowers the near sensor's output."""
    phrases = []
    for series in found:
        near = series.points[0]
        change = near.coupling.value / near.coupling_alone.value - 1
        sentence = (
            f"{_far(series.separation)} apart the sensors are coupled by {near.coupling_alone.value / PICOFARAD:.3g} pF, which "
            f"the object at {_far(near.gap)} changes by {signed_percent(change)}"
        )
        taken = [
            (p.near.delta_self.value / p.single.value - 1, p.gap)
            for p in series.points
            if p.single is not None
        ]
        if taken:
            most, gap = max(taken, key=lambda each: abs(each[0]))
            sentence += (
                f"; beside the neighbour the near sensor's delta_self differs from that of a sensor alone by up to {signed_percent(most)}, "
                f"at {_far(gap)}"
            )
        phrases.append(sentence)
    return ". ".join(phrases) + "."


def _felt(series: Series) -> Panel:
    """Returns both sensors' delta_self over the gap with error bars, and the model's values."""
    gaps, cases = [point.gap / CENTIMETRE for point in series.points], [point.case for point in series.points]
    both = {
        "near sensor": [point.near for point in series.points],
        "neighbour": [point.neighbour for point in series.points],
    }
    traces, hover = [], "%{y:.4g} pF at %{x:.3g} cm"
    for index, (name, felt) in enumerate(both.items()):
        colour, more = series_colour(index), {"customdata": cases}
        known, model = [each.delta_self for each in felt], [each.model / PICOFARAD for each in felt]
        traces.append(estimated(f"{name}: reference", gaps, known, colour, hover, **more))
        traces.append(joined(f"{name}: model", gaps, model, colour, hover, **more, mode="lines", dash="dash"))
    y = power_axis("delta_self, model (pF)")
    caption = f"sensors {_far(series.separation)} apart"
    return Panel(caption, figure(traces, log_axis("gap to the object (cm)"), y, 440))


def _coupling(found: list[Series]) -> Panel:
    traces = []
    for index, series in enumerate(found):
        gaps = [point.gap / CENTIMETRE for point in series.points]
        name, cases = f"{_far(series.separation)} apart", [point.case for point in series.points]
        colour, hover = series_colour(index), "%{y:.4g} pF at %{x:.3g} cm"
        coupling = [point.coupling for point in series.points]
        traces.append(estimated(name, gaps, coupling, colour, hover, customdata=cases))
        alone = [series.points[0].coupling_alone.value / PICOFARAD] * 2
        traces.append(guide("the same without the object", [gaps[0], gaps[-1]], alone, color=colour))
    y = axis("coupling of the sensors (pF)", rangemode="tozero")
    return Panel(
        "coupling of the two sensors, reference", figure(traces, log_axis("gap to the object (cm)"), y, 440)
    )


def _table(found: list[Series]) -> Markup:
    felt = [
        (series, point, name, each)
        for series in found
        for point in series.points
        for name, each in (("near", point.near), ("neighbour", point.neighbour))
    ]
    return page.table_of(
        felt,
        ("apart", lambda row: _far(row[0].separation)),
        ("gap", lambda row: page.case_link(row[1].case, _far(row[1].gap))),
        ("sensor", lambda row: row[2]),
        ("delta_self (pF)", lambda row: picofarads(row[3].delta_self.value, row[3].delta_self.error)),
        ("mutual (pF)", lambda row: picofarads(row[3].mutual.value, row[3].mutual.error)),
        ("model (pF)", lambda row: f"{row[3].model / PICOFARAD:.5f}"),
        ("coupling (pF)", lambda row: picofarads(row[1].coupling.value, row[1].coupling.error)),
        text_columns=3,
    )


def _far(length: float) -> str:
    return place(length, DISTANCE)


_FAMILY = "box"


@dataclass(frozen=True)
class MaterialPoint:
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
    points: tuple[MaterialPoint, ...]

    @property
    def is_grounded(self) -> bool:
        return self.name == GROUNDED

    @property
    def label(self) -> str:
        return self.name if self.permittivity is None else f"{self.name}, ε = {self.permittivity:g}"


def materials(results: Results) -> list[Material]:
    """Returns every material that has answers, in the study's order."""
    found: dict[tuple[str, float | None], list[MaterialPoint]] = {}
    for case in results.compared():
        if case.family == _FAMILY and case.truth is not None:
            found.setdefault(_material(case), []).append(_material_point(case))
    return [
        Material(name, permittivity, tuple(sorted(points, key=lambda point: point.gap)))
        for (name, permittivity), points in found.items()
    ]


def ratios(material: Material, grounded: Material) -> list[tuple[MaterialPoint, float]]:
    """Returns delta_self relative to that of the grounded target at the same gap."""
    there = {point.gap: point.delta_self.value for point in grounded.points}
    return [
        (point, point.delta_self.value / there[point.gap]) for point in material.points if point.gap in there
    ]


def _material(case: CaseResult) -> tuple[str, float | None]:
    name, permittivity = case.parameters["material"], case.parameters["relative_permittivity"]
    assert isinstance(name, str) and isinstance(permittivity, float)
    return name, permittivity if name == DIELECTRIC else None


def _material_point(case: CaseResult) -> MaterialPoint:
    assert case.truth is not None
    sensor = case.scene.sensors[0].name
    model = None if case.model is None else case.model.values[COMPARED_METHOD][sensor].total
    return MaterialPoint(case.id, number(case, DISTANCE), case.truth.delta_self(sensor).best, model)


_WHAT_OF_MATERIALS = (
    "Floating: a conductor without total charge, which is also the limit of a large permittivity. The model applies to grounded conductors "
    "only: its line is that of the grounded target. mutual exists only for the grounded target, so all values are delta_self."
)


def parts_of_materials(results: Results) -> list[Markup]:
    """Returns the findings, delta_self over the gap by material, its ratio to the grounded target, and every number."""
    found = materials(results)
    grounded = next((each for each in found if each.is_grounded), None)
    if grounded is None:
        return [page.paragraph("No grounded target has an answer to compare the others with.")]
    others = [each for each in found if ratios(each, grounded) and not each.is_grounded]
    return [
        page.finding(materials_finding(grounded, others)),
        page.figures([_felt_by_material(found, grounded), _ratios(others, grounded)]),
        page.finding(model_finding(grounded, others)),
        page.folded("Show the numbers", _materials(found, grounded)),
        page.soft(_WHAT_OF_MATERIALS),
    ]


def materials_finding(grounded: Material, others: list[Material]) -> str:
    """Tells each material's delta_self relative to the grounded target's, near and far."""
    phrases = []
    for each in others:
        (near, close), (far, distant) = ratios(each, grounded)[0], ratios(each, grounded)[-1]
        phrases.append(
            f"{each.label}: {100 * close:.2g} % at {place(near.gap, DISTANCE)}, {100 * distant:.2g} % at {place(far.gap, DISTANCE)}"
        )
    return (
        f"Of what the grounded target gives in delta_self: {'; '.join(phrases)}."
        if phrases
        else "There is no other material."
    )


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


def _felt_by_material(found: list[Material], grounded: Material) -> Panel:
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


def _materials(found: list[Material], grounded: Material) -> Markup:
    return page.table_of(
        [(each, *pair) for each in found for pair in ratios(each, grounded)],
        ("material", lambda row: row[0].label),
        ("gap", lambda row: page.case_link(row[1].case, place(row[1].gap, DISTANCE))),
        ("delta_self (pF)", lambda row: picofarads(row[1].delta_self.value, row[1].delta_self.error)),
        ("of grounded", lambda row: f"{100 * row[2]:.2f} %"),
        ("model (pF)", lambda row: "" if row[1].model is None else f"{row[1].model / PICOFARAD:.5f}"),
        text_columns=2,
    )
