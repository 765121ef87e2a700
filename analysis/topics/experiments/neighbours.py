"""Experiment V: the interaction of two adjacent sensors and an object near one of them, from the answers of a study to its report."""

from dataclasses import dataclass

from markupsafe import Markup

from analysis.report import page
from analysis.report.plot import Panel, axis, figure, guide, joined, log_axis, power_axis, series_colour
from analysis.results.answers import Estimate
from analysis.results.statistics import grouped
from analysis.results.study_results import COMPARED_METHOD, CaseResult, Results
from analysis.results.units import CENTIMETRE, percent, signed_percent
from analysis.topics.experiments.curves import DISTANCE, estimated, is_answered, number, place
from geometries.common.measured import PICOFARAD

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
    pairs = (case for case in results.compared() if case.family == FAMILY and is_answered(results, case))
    return [
        Series(separation, tuple(sorted((_point(results, case) for case in own), key=lambda each: each.gap)))
        for separation, own in grouped(pairs, lambda case: number(case, "separation")).items()
    ]


def _point(results: Results, case: CaseResult) -> Point:
    truth, alone = case.truth, results.cases[case.empty].truth
    assert truth is not None and alone is not None and case.model is not None
    target = case.scene.objects[0].name
    values = case.model.values[COMPARED_METHOD]
    known = ((name, truth.delta_self(name), truth.mutual(name, target)) for name in (NEAR, NEIGHBOUR))
    near, neighbour = (Felt(own.best, to.best, values[name].objects[target]) for name, own, to in known)
    coupling, without = (each.mutual(NEAR, NEIGHBOUR).best for each in (truth, alone))
    gap, single = number(case, "gap"), _single(results, case)
    return Point(case.id, gap, near, neighbour, coupling, without, single)


def _single(results: Results, case: CaseResult) -> Estimate | None:
    """Finds delta_self of the same set-up without the neighbour."""
    same = {name: case.parameters[name] for name in ("sensor_size", "target_size", "gap", "offset")}
    for other in results.compared():
        alike = other.family == ALONE and same.items() <= other.parameters.items()
        if alike and other.truth is not None:
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
        beside = [(p.near.delta_self.value, p.single, p.gap) for p in series.points]
        taken = [(value / single.value - 1, gap) for value, single, gap in beside if single is not None]
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
    near, neighbour = zip(*((point.near, point.neighbour) for point in series.points))
    both = {"near sensor": near, "neighbour": neighbour}
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
    drawn = figure(traces, log_axis("gap to the object (cm)"), y, 440)
    return Panel("coupling of the two sensors, reference", drawn)


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
        ("delta_self (pF)", lambda row: row[3].delta_self.in_picofarads),
        ("mutual (pF)", lambda row: row[3].mutual.in_picofarads),
        ("model (pF)", lambda row: f"{row[3].model / PICOFARAD:.5f}"),
        ("coupling (pF)", lambda row: row[1].coupling.in_picofarads),
        text_columns=3,
    )


def _far(length: float) -> str:
    return place(length, DISTANCE)
