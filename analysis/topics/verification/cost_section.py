"""The report's section on the reference's run time against error."""

from __future__ import annotations

import math

import plotly.graph_objects as go
from markupsafe import Markup

from analysis.report import page
from analysis.report.plot import Panel, figure, power_axis, series_colour
from analysis.topics.verification.records import Cost, Point

TITLE = "Run time against error of the reference"
KNOWN = 1e-2
"""Relative error up to which a best known value serves as truth; a worse one comes from a reference stopped by its time limit."""
_WHAT = (
    "Errors are the largest of any entry of the Maxwell matrix, relative to the best known value: the truth, or the reference's own "
    "answer with the smallest stated error; errors below the error of that value are drawn at it, as open symbols. Seconds are counted from the start, "
    "so that those of a mesh include all coarser ones. Every solve uses one core; as many run at the same time as there are cores. "
    "Elements of one size, not graded to edges, gave a square plate 12 % too much with 900 unknowns, where the first graded mesh, of 7,800, is "
    "0.09 % off (commit 10927ca5)."
)


def section(costs: list[Cost]) -> Markup:
    """Returns the finding, the targets, a panel for each set-up, and every point."""
    if not costs:
        return Markup("")
    known = [cost for cost in costs if cost.best_to <= KNOWN]
    panels = [Panel(f"{cost.caption}. {case_finding(cost)}", _panel(cost, _ranges(known))) for cost in known]
    return page.section(
        TITLE,
        page.finding(target_finding(costs)),
        page.figures(panels),
        page.soft(_WHAT),
        page.heading("What was asked for"),
        _targets(costs),
        page.folded("Every mesh", _table(known)),
    )


def case_finding(cost: Cost) -> str:
    """Tells the answer with its error."""
    end = cost.answers[0]
    sentence = f"The estimate is {_error(end.error, cost)} off after {end.seconds:.1f} s"
    if cost.widths:
        sentence += f"; the enclosure is ±{cost.widths[-1].error:.2g} after {cost.widths[-1].seconds:.1f} s"
    return f"{sentence}."


def target_finding(costs: list[Cost]) -> str:
    targets = [(cost, target) for cost in costs for target in cost.targets]
    missed = [f"{cost.caption}, {target.rtol:g}" for cost, target in targets if not target.met]
    sentence = f"{len(targets) - len(missed)} of {len(targets)} errors asked for were stated in time"
    return f"{sentence}; not: {'; '.join(missed)}." if missed else f"{sentence}."


def _error(error: float, cost: Cost) -> str:
    return f"{error:.1e}" if error > cost.best_to else f"at most {cost.best_to:.1e}"


def _targets(costs: list[Cost]) -> Markup:
    return page.table_of(
        [(cost, target) for cost in costs for target in cost.targets],
        ("set-up", lambda each: each[0].caption),
        ("error asked for", lambda each: f"{each[1].rtol:.0e}"),
        ("within (s)", lambda each: f"{each[1].allowed_seconds:g}"),
        ("stated", lambda each: f"{each[1].stated:.1e}"),
        ("after (s)", lambda each: f"{each[1].seconds:.1f}"),
        ("off by", lambda each: _error(each[1].error, each[0])),
        ("in time", lambda each: page.yes_or_no(each[1].met)),
    )


def _series(cost: Cost) -> list[tuple[str, tuple[Point, ...], int, str, str]]:
    return [
        ("reference, each mesh", cost.meshes, 0, "circle", "lines+markers"),
        ("reference, extrapolated", cost.answers, 0, "star", "markers"),
        ("enclosure, half its width", cost.widths, 2, "square", "lines+markers"),
    ]


def _panel(cost: Cost, ranges: tuple[list[float], list[float]]) -> go.Figure:
    traces = []
    for name, points, colour, symbol, mode in _series(cost):
        symbols = [symbol if point.error > cost.best_to else f"{symbol}-open" for point in points]
        traces.append(
            go.Scatter(
                x=[point.seconds for point in points],
                y=[max(point.error, cost.best_to) for point in points],
                mode=mode,
                customdata=[point.unknowns for point in points],
                marker={
                    "color": series_colour(colour),
                    "symbol": symbols,
                    "size": 14 if symbol == "star" else 8,
                },
                line={"color": series_colour(colour)},
                name=name,
                hovertemplate="%{x:.2g} s, %{y:.1e}, %{customdata:,} unknowns<extra>" + name + "</extra>",
            )
        )
    x = power_axis("seconds", range=ranges[0])
    return figure(traces, x, power_axis("largest relative error", range=ranges[1]), height=380)


def _ranges(costs: list[Cost]) -> tuple[list[float], list[float]]:
    """Returns the exponents of ten at the ends of the axes, the same for all panels."""
    points = [(point, cost) for cost in costs for _, series, *_ in _series(cost) for point in series]
    seconds = [math.log10(point.seconds) for point, _ in points]
    errors = [math.log10(max(point.error, cost.best_to)) for point, cost in points]
    return [min(seconds) - 0.2, max(seconds) + 0.2], [min(errors) - 0.3, max(errors) + 0.3]


def _table(costs: list[Cost]) -> Markup:
    rows = []
    for cost in costs:
        known = f"{cost.best_from}, {cost.best_to:.0e}"
        for name, points, *_ in _series(cost):
            for point in points:
                cells = [f"{point.unknowns:,}", f"{point.seconds:.2f}", _error(point.error, cost)]
                rows.append([cost.caption, name, *cells, known])
    header = ["set-up", "method", "unknowns", "seconds", "error", "best known value"]
    return page.table(header, rows, text_columns=2)
