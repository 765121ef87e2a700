"""The section on run time against error: one plot with its finding."""

import math
from dataclasses import dataclass

import numpy as np
import plotly.graph_objects as go
from markupsafe import Markup

from analysis.report import page
from analysis.report.plot import Panel, figure, guide, power_axis, series_colour
from analysis.results.answers import Estimate, MatrixAnswer
from analysis.results.statistics import front
from analysis.results.store import Document
from analysis.results.study_results import Results
from analysis.results.units import duration, percent
from analysis.topics.trade_off import measure

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

    def point(kind: str, name: str, answers: dict[str, tuple[float, float]]) -> Point:
        """Makes a point of a method, whose values and seconds are given by case."""
        errors = {case: abs(float(value / truths[case] - 1)) for case, (value, _) in answers.items()}
        sizes, seconds = list(errors.values()), np.median([taken for _, taken in answers.values()])
        middle, most = float(np.median(sizes)), float(np.quantile(sizes, 0.95))
        return Point(kind, name, float(seconds), middle, most, max(errors, key=lambda case: errors[case]))

    found = []
    for entry in document["methods"]:
        answers = {case: (entry["values"][case], entry["seconds"][case]) for case in truths}
        found.append(point(entry["kind"], entry["name"], answers))
    solved = _solved(document, results)
    for depth in range(max((len(answer.levels) for answer in solved.values()), default=0)):
        there = {case: answer.levels[depth] for case, answer in solved.items() if len(answer.levels) > depth}
        if len(there) >= _LEAST_SHARE * len(solved):
            meshes = {case: (-float(level.maxwell[0, 1]), level.seconds) for case, level in there.items()}
            found.append(point(MESH, f"{depth + 1}", meshes))
    if solved:
        whole = {case: (-float(answer.maxwell[0, 1]), answer.seconds) for case, answer in solved.items()}
        found.append(point(ANSWER, "answer", whole))
    return found


def _solved(document: Document, results: Results) -> dict[str, MatrixAnswer]:
    """Returns the field solver's answers, by case, of the set-ups that have a truth."""
    cases = (results.cases[case] for case in document["truths"] if case in results.cases)
    return {case.id: case.reference for case in cases if case.reference is not None}


def known_to(document: Document) -> float:
    """Returns the median relative error of the truths; errors below it cannot be distinguished."""
    return float(np.median([truth["error"] / truth["mutual"] for truth in document["truths"].values()]))


def agreement(document: Document, results: Results) -> tuple[int, int]:
    """Returns how many truths lie within the field solver's error and their own, and how many it has solved."""
    solved = _solved(document, results)
    agreeing = 0
    for case, reference in solved.items():
        value, truth = reference.mutual(*reference.conductors), document["truths"][case]
        agreeing += value.agrees_with(Estimate(truth["mutual"], truth["error"]))
    return agreeing, len(solved)


TITLE = "Run time against error of all methods"
_SERIES = {
    "thesis": ("split:N, the thesis' method", 0, "circle", "lines+markers+text"),
    "model": ("exact, the same integral", 6, "star", "markers+text"),
    "formula": ("formula", 1, "square", "markers+text"),
    "reduced": ("reduced by rtol", 2, "triangle-up", "lines+markers+text"),
    "boundary elements": ("boundary elements by rtol", 4, "diamond", "lines+markers+text"),
    MESH: (MESH, 3, "x", "lines+markers+text"),
    ANSWER: (ANSWER, 3, "star", "markers"),
}
# Methods with a label; others lie so close together that labels would cover them, and show their name under the pointer.
_NAMED_OF_SPLITS = ("split:0", "split:4", "split:8")
_BETTER_THAN_PLAIN = 0.75
_ACCURACIES = (0.1, 0.01, 0.001)


def section(document: Document | None, results: Results, cases: str) -> Markup:
    """Returns the finding, the plot and what it shows; empty without a measurement. `cases` is the folder of the cases as seen from the page."""
    if document is None or not document["truths"]:
        return Markup("")
    found, count = points(document, results), len(document["truths"])
    caption = f"median over {count} set-ups of one plate before another; the bars end at 95 % of them"
    return page.section(
        TITLE,
        page.finding(finding(found, document)),
        page.figures([Panel(caption, plot(found, known_to(document)))], cases),
        page.soft(_explanation(document, results)),
    )


def finding(found: list[Point], document: Document) -> str:
    """Tells time and error from the plain model to the field solver, and compares the reduced method with an equally accurate mesh."""
    named = {point.name: point for point in found}
    exact, fast, best = named["exact"], named["reduced 1e-3"], named["formula"]
    seconds = [point.seconds for point in found]
    sentence = (
        f"Over {len(document['truths'])} set-ups the plain model takes {duration(exact.seconds, 2)} and is {percent(exact.error)} off in mutual "
        f"(medians), the {best.name} {duration(best.seconds, 2)} and {percent(best.error)}, {fast.name} "
        f"{duration(fast.seconds, 2)} and {percent(fast.error)}"
    )
    matched = [point for point in found if point.kind == MESH and point.error >= fast.error]
    if matched:
        last = matched[-1]
        # To one digit: a ratio of times measured on different days is not known better.
        ratio = f"{float(f'{last.seconds / fast.seconds:.0e}'):,.0f} times as long"
        sentence += f"; mesh {last.name} of the field solver is {percent(last.error)} off after {duration(last.seconds, 2)}, {ratio}"
    return f"{sentence}. The plot spans {math.log10(max(seconds) / min(seconds)):.1f} decades of time."


def advice(document: Document | None, results: Results) -> str:
    """Tells the fastest method for each accuracy, in words; empty without a measurement."""
    if document is None or not document["truths"]:
        return ""
    found = sorted(points(document, results), key=lambda point: point.seconds)
    reached: dict[Point, list[str]] = {}
    for accuracy in _ACCURACIES:
        best = next((point for point in found if point.percentile_95 <= accuracy), None)
        if best is not None:
            reached.setdefault(best, []).append(percent(accuracy))
    told = []
    for best, accuracies in reached.items():
        told.append(f"{' or '.join(accuracies)}: {_in_words(best)}, {duration(best.seconds, 2)} a pose")
    return f"For an error of at most {'; '.join(told)} (in 95 of 100 set-ups)." if told else ""


def _in_words(point: Point) -> str:
    if point.kind == "reduced":
        return f"{point.name}, also of a robot that moves"
    named = {"model": "the plain model", "thesis": "the plain model", "formula": "the formula"}
    return named.get(point.kind, point.kind)


def plot(found: list[Point], known_to: float) -> go.Figure:
    """Plots every series, the Pareto front, and the error of the truth. Smaller errors are drawn there as open symbols."""
    # Errors below that of the truth count as equal on the front.
    places = [(point.seconds, max(point.error, known_to)) for point in found]
    fastest, errors = zip(*front(places, lambda place: place))
    traces = [guide("front: none is faster and better", fastest, errors, shape="hv")]
    (plain,) = (point.error for point in found if point.kind == "model")
    for kind, (name, colour, symbol, mode) in _SERIES.items():
        members = [point for point in found if point.kind == kind]
        if members:
            traces.append(_series(name, members, colour, symbol, mode, known_to, plain))
    seconds = [point.seconds for point in found]
    ends = [math.log10(min(seconds)) - 0.4, math.log10(max(seconds)) + 0.5]
    whole = [10**end for end in ends]
    traces.append(guide("what the truth is known to", whole, [known_to] * 2, width=1, dash="dash"))
    x = power_axis("seconds for one pose", range=ends)
    return figure(traces, x, power_axis("relative error in mutual"), height=560)


def _series(
    name: str, members: list[Point], colour: int, symbol: str, mode: str, known_to: float, plain: float
) -> go.Scatter:
    shown, paint = [max(point.error, known_to) for point in members], {"color": series_colour(colour)}
    above = [max(point.percentile_95 - error, 0) for point, error in zip(members, shown)]
    bars = {"type": "data", "symmetric": False, "array": above, "arrayminus": [0] * len(members)}
    symbols = [symbol if point.error > known_to else f"{symbol}-open" for point in members]
    return go.Scatter(
        x=[point.seconds for point in members],
        y=shown,
        error_y=bars | {"thickness": 0.8, "width": 2} | paint,
        mode=mode,
        text=[_label(point, plain) for point in members],
        textposition="bottom center" if members[0].kind == "formula" else "top right",
        textfont={"size": 10},
        customdata=[point.worst for point in members],
        hovertext=[point.name for point in members],
        cliponaxis=False,
        marker=paint | {"symbol": symbols, "size": 14 if symbol == "star" else 8},
        line=paint,
        name=name,
        hovertemplate="%{hovertext}: %{x:.2g} s, %{y:.1e}<extra>" + name + "</extra>",
    )


def _label(point: Point, plain: float) -> str:
    """Writes the label of a point; `plain` is the error of the plain model."""
    if point.kind == "formula" and point.error > _BETTER_THAN_PLAIN * plain:
        return ""
    if point.kind == "thesis":
        return point.name.partition(":")[2] if point.name in _NAMED_OF_SPLITS else ""
    return point.name.removeprefix("reduced ")


def _explanation(document: Document, results: Results) -> str:
    agreeing, total = agreement(document, results)
    truth = (
        f"The truth is that of boundary elements at rtol = {document['truth_rtol']:g}, its stated error {known_to(document):.0e} in "
        f"the median; it lies within the field solver's error bar in {agreeing} of {total} set-ups."
    )
    return (
        "A click on a point opens the case in which that method is worst. "
        f"{truth} Times of the model, the formula, the reduced method and boundary elements: one core, one run, methods taking turns at "
        "every pose, after a move, with prepared bodies; the smallest of several. Those of the field solver are the seconds of each mesh when "
        f"the study was solved, and of the whole answer. {document['processor']} with {document['instruction_sets']}. Again, from the "
        f"project's folder: {measure.command(results.folder)}"
    )
