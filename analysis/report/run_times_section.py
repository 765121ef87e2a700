"""The report's section on how long the model's methods take and how wrong they are, on fixed sets of triangles."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import plotly.graph_objects as go
from markupsafe import Markup

from analysis.report import measured, page
from analysis.report.measured import Origin, origin
from analysis.report.plot import Panel, figure, guide, power_axis, series_colour
from analysis.results.store import Document, read_json
from analysis.results.study_results import RUN_TIMES
from analysis.results.units import duration

Point = tuple[float, float]

_CHARACTER, _LINE = 6.0, 12.0
"""Width of a character and height of a line (pixels) in the font that labels have."""
_CLEAR = 7.0
"""Distance (pixels) of a label from the middle of its point."""
_PLACES = ("top right", "bottom right", "top left", "bottom left", "top center", "bottom center")


def placed(points: Sequence[Point], labels: Sequence[str]) -> list[str | None]:
    """Returns for each label where it stands, in plotly's words; None where there is no room for it or it is empty.

    `points` are in pixels, y upwards. Earlier labels are placed first.
    """
    taken = [_Box(x - _CLEAR / 2, y - _CLEAR / 2, x + _CLEAR / 2, y + _CLEAR / 2) for x, y in points]
    chosen: list[str | None] = []
    for own, (point, label) in enumerate(zip(points, labels)):
        others = taken[:own] + taken[own + 1 :]
        boxes = {place: _box(point, label, place) for place in _PLACES}
        free = [place for place in _PLACES if not any(boxes[place].meets(other) for other in others)]
        chosen.append(free[0] if free and label else None)
        if chosen[-1] is not None:
            taken.append(boxes[free[0]])
    return chosen


@dataclass(frozen=True)
class _Box:
    """Its sides in pixels, y upwards."""

    left: float
    bottom: float
    right: float
    top: float

    def meets(self, other: _Box) -> bool:
        across = self.left < other.right and other.left < self.right
        return across and self.bottom < other.top and other.bottom < self.top


def _box(point: Point, label: str, place: str) -> _Box:
    x, y = point
    width = _CHARACTER * len(label)
    vertical, horizontal = place.split()
    left = {"right": x + _CLEAR / 2, "left": x - _CLEAR / 2 - width, "center": x - width / 2}[horizontal]
    bottom = y + _CLEAR / 2 if vertical == "top" else y - _CLEAR / 2 - _LINE
    return _Box(left, bottom, left + width, bottom + _LINE)


TITLE = "Run time against error of the integral"
EXACT, THESIS = "exact", "split:4"

_NANOSECOND = 1e-9
# Half a unit in the last place of 1. Smaller errors are those of rounding the result; zero has no logarithm.
_ROUNDING = 2.0**-54
_HEIGHT = 340
_INSIDE = (430.0, 240.0)
"""Pixels between the axes of a panel on a screen on which two stand beside each other."""
_SYMBOLS = ("star", "circle", "square", "diamond", "triangle-up", "x", "cross")
_SETS = (
    "Triangles in the regions I (in front of the plate), II (beside an edge) and III (diagonal to a corner), of 0.02 (fine) "
    "and 0.3 (coarse) of their distance in size; small ones astride two cells around the plate, as a fine mesh has them; "
    "triangles larger than the plate that reach into up to nine cells; a closed mesh around all cells. split:N is the "
    "thesis' method with 4^N equal triangles, gauss:K a product rule of K² nodes; exact lays the triangles out anew each time, "
    "batch has them laid out once, tolerance:T too and each triangle within T; tree:T gives only the sum, within T, by a tree "
    "made once. Errors are relative to quadrature in extended precision, the largest of the set or, where a method is slow, of "
    "an evenly spread sample; times are those of one core, the smallest of three."
)


@dataclass(frozen=True)
class MethodTime:
    """One method on one set of triangles. `error` is the largest relative error, `triangles` how many were evaluated."""

    set: str
    method: str
    seconds_per_triangle: float
    error: float
    triangles: int


@dataclass(frozen=True)
class RunTimes:
    """Every method on every set, in the benchmark's order."""

    origin: Origin
    compiler: str
    times: tuple[MethodTime, ...]


def load(folder: Path) -> RunTimes | None:
    """Returns what was measured, in a folder of results."""
    return run_times(read_json(folder / RUN_TIMES))


def run_times(document: Document | None) -> RunTimes | None:
    """Returns the times in a stored answer of the benchmark; None without one."""
    if document is None:
        return None
    answer = document["answer"]
    # The minimum over the repetitions: other work on the machine only makes a method slower.
    found: dict[tuple[str, str], MethodTime] = {}
    # Their repetitions come in any order; the index says where the benchmark has them.
    for entry in sorted(answer["benchmarks"], key=lambda entry: int(entry["family_index"])):
        if entry["run_type"] == "iteration":
            time = _method_time(entry)
            known = found.get((time.set, time.method), time)
            found[time.set, time.method] = min(known, time, key=lambda t: t.seconds_per_triangle)
    return RunTimes(origin(document), answer["context"]["compiler"], tuple(found.values()))


def _method_time(entry: Document) -> MethodTime:
    name, method = entry["name"].split("/")[:2]
    return MethodTime(
        name, method, float(entry["per_triangle"]), float(entry["error"]), int(entry["triangles"])
    )


def section(found: RunTimes | None) -> Markup:
    """Returns the finding, a panel for each set of triangles, the table, and how to measure again."""
    return measured.section(TITLE, found, _parts)


def _parts(found: RunTimes) -> Iterator[Markup]:
    sets = by_set(found)
    methods = list(dict.fromkeys(time.method for time in found.times))
    yield page.finding(finding(sets))
    yield page.figures([Panel(_caption(times), _panel(times, found)) for times in sets.values()])
    yield page.paragraph(
        "ns per triangle, and the largest relative error below. Bold: no other method is both faster and more accurate."
    )
    yield _table(sets, methods)
    yield page.soft(_SETS)
    yield measured.again(found.origin, before=f"Compiler {found.compiler}; ")


def by_set(found: RunTimes) -> dict[str, list[MethodTime]]:
    """Returns the times of each set, sets and methods in the benchmark's order."""
    sets: dict[str, list[MethodTime]] = {}
    for time in found.times:
        sets.setdefault(time.set, []).append(time)
    return sets


def front(times: list[MethodTime]) -> list[MethodTime]:
    """Returns the Pareto front: the methods that no other method beats in both time and error, from fast to accurate."""
    best: list[MethodTime] = []
    for time in sorted(times, key=lambda t: (t.seconds_per_triangle, t.error)):
        if not best or time.error < best[-1].error:
            best.append(time)
    return best


def finding(sets: dict[str, list[MethodTime]]) -> str:
    """Compares the exact method with the thesis' over all sets, and names the methods on a Pareto front."""
    pairs = []
    for times in sets.values():
        named = {time.method: time for time in times}
        if EXACT in named and THESIS in named:
            pairs.append((named[EXACT], named[THESIS]))
    best = {time.method for times in sets.values() for time in front(times)}
    methods = dict.fromkeys(time.method for times in sets.values() for time in times)
    chosen = [method for method in methods if method in best]
    sentence = f"On the front between run time and error, on one set or another, are {', '.join(chosen)}."
    if not pairs:
        return sentence
    ratios = sorted(thesis.seconds_per_triangle / exact.seconds_per_triangle for exact, thesis in pairs)
    worst_exact = max(exact.error for exact, _ in pairs)
    errors = sorted(thesis.error for _, thesis in pairs)
    return (
        f"The method {EXACT} is right to {worst_exact:.1e} on every set. The thesis' {THESIS} takes from {ratios[0]:.2g} to "
        f"{ratios[-1]:.2g} times as long and is wrong by {errors[0]:.0e} to {errors[-1]:.0e}. {sentence}"
    )


def _caption(times: list[MethodTime]) -> str:
    """Names the set and the cost of the exact method on it relative to the thesis'."""
    named = {time.method: time for time in times}
    times_of_methods = "; ".join(
        f"{method} {duration(named[method].seconds_per_triangle)}, off by {named[method].error:.0e}"
        for method in (EXACT, THESIS)
        if method in named
    )
    what = f"{_words(times[0].set)}, {max(time.triangles for time in times):,} triangles"
    return f"{what}: {times_of_methods}" if times_of_methods else what


def _words(name: str) -> str:
    return name.replace("_", " ")


def _panel(times: list[MethodTime], found: RunTimes) -> go.Figure:
    """Plots one set; all panels have the same axes and colours."""
    kinds = list(dict.fromkeys(_kind(time.method) for time in found.times))
    best = front(times)
    x_range = _range([time.seconds_per_triangle / _NANOSECOND for time in found.times])
    y_range = _range([max(time.error, _ROUNDING) for time in found.times])
    labels = [time.method.partition(":")[2] for time in times]
    where = dict(
        zip(
            (time.method for time in times),
            placed([_pixels(time, x_range, y_range) for time in times], labels),
        )
    )
    fastest = [time.seconds_per_triangle / _NANOSECOND for time in best]
    traces = [guide("front", fastest, [max(time.error, _ROUNDING) for time in best], shape="hv")]
    for index, kind in enumerate(kinds):
        members = [time for time in times if _kind(time.method) == kind]
        traces.append(
            go.Scatter(
                x=[time.seconds_per_triangle / _NANOSECOND for time in members],
                y=[max(time.error, _ROUNDING) for time in members],
                mode="markers+text",
                text=[time.method.partition(":")[2] if where[time.method] else "" for time in members],
                textposition=[where[time.method] or "top right" for time in members],
                textfont={"size": 10},
                customdata=[time.method for time in members],
                cliponaxis=False,
                marker={"color": series_colour(index), "symbol": _SYMBOLS[index % len(_SYMBOLS)], "size": 9},
                name=kind,
                hovertemplate="%{customdata}: %{x:.3g} ns, %{y:.2g}<extra></extra>",
            )
        )
    x = power_axis("ns per triangle", range=x_range)
    return figure(traces, x, power_axis("largest relative error", decades=3, range=y_range), height=_HEIGHT)


def _pixels(time: MethodTime, x_range: list[float], y_range: list[float]) -> tuple[float, float]:
    """Returns about where a point is in its panel."""
    x = math.log10(time.seconds_per_triangle / _NANOSECOND)
    y = math.log10(max(time.error, _ROUNDING))
    shares = [(value - low) / (high - low) for value, (low, high) in ((x, x_range), (y, y_range))]
    return _INSIDE[0] * shares[0], _INSIDE[1] * shares[1]


def _range(values: list[float]) -> list[float]:
    """Returns the exponents of ten at the ends of an axis, with a margin for the marks on the edge."""
    return [math.log10(min(values)) - 0.5, math.log10(max(values)) + 0.5]


def _kind(method: str) -> str:
    return method.partition(":")[0]


def _table(sets: dict[str, list[MethodTime]], methods: list[str]) -> Markup:
    cells = {}
    for name, times in sets.items():
        best = {time.method for time in front(times)}
        cells.update({(name, time.method): _cell(time, time.method in best) for time in times})
    rows = [[page.code(method), *(cells.get((name, method), "") for name in sets)] for method in methods]
    return page.table(["method", *map(_words, sets)], rows)


def _cell(time: MethodTime, strong: bool) -> str:
    nanoseconds = time.seconds_per_triangle / _NANOSECOND
    text = f"{nanoseconds:,.0f}" if nanoseconds >= 100 else f"{nanoseconds:.3g}"
    cell = page.two_lines(text, f"{time.error:.0e}")
    return page.strong(cell) if strong else cell
