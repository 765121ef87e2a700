"""The report's section on the integral's errors, compared with its conditioning: the effect of rounding its input."""

from __future__ import annotations

import plotly.graph_objects as go
from markupsafe import Markup

from analysis.report import page
from analysis.report.plot import Panel, axis, figure, guide, power_axis, series_colour
from analysis.results import measurements
from analysis.results.measurements import MethodErrors, Stability, StabilityClass

TITLE = "Stability of the integral"
EXACT, _THESIS = "exact", "thesis"

_LABELS = {_THESIS: "the thesis' formula"}
# The legend lies above the figure, because the names of the classes need the room below.
_LEGEND = {"orientation": "h", "y": 1.02, "yanchor": "bottom", "x": 0, "xanchor": "left"}
_SYMBOLS = ("star", "circle", "square", "diamond")
_WHAT = (
    "Conditioning is the largest relative change of the true value when the coordinates of triangle and plate move by one unit "
    "in the last place, at least 1.2e-16: a method that stays below a small multiple of it is as accurate as its input. The "
    "truth is quadrature of the distance itself in multiple precision, without any closed form. The thesis' formula (5.3.1) "
    "is for region I and is asked there only."
)


def section(measured: Stability | None) -> Markup:
    """Returns the finding, the error over the conditioning of every class, and the counts of wrong values."""
    if measured is None:
        return page.section(TITLE, page.paragraph(measurements.NOT_MEASURED))
    return page.section(
        TITLE,
        page.finding(finding(measured)),
        page.figures([Panel("error over conditioning, by class of triangles", _figure(measured))]),
        page.paragraph("Largest error over conditioning, values not finite, values wrong by more than 1 %."),
        _table(measured),
        page.soft(_WHAT),
        page.soft(
            f"{measured.origin.processor} with {measured.origin.instruction_sets}. Again, from the project's folder: "
            f"{measured.origin.command}"
        ),
    )


def finding(measured: Stability) -> str:
    """Tells whether the exact method keeps the limit, where it does not, and the worst of every method over all classes."""
    failing = [entry.name for entry in measured.classes if _fails(entry, measured.limit)]
    if failing or not measured.passed:
        verdict = f"{EXACT} fails" + (f", in: {', '.join(failing)}." if failing else ".")
    else:
        verdict = f"{EXACT} keeps the limit of {measured.limit:g} in all {len(measured.classes)} classes."
    sentences = [verdict, *(_sentence(measured, method) for method in methods_of(measured))]
    failed = sum(entry.truth_failed for entry in measured.classes)
    if failed:
        sentences.append(f"The quadrature failed for {failed:,} triangles.")
    return " ".join(sentences)


def methods_of(measured: Stability) -> list[str]:
    """Returns the methods that any class was evaluated with, the exact one first, then the thesis'."""
    return sorted({name for entry in measured.classes for name in entry.methods}, key=_rank)


def _rank(method: str) -> tuple[bool, bool, str]:
    return method != EXACT, method != _THESIS, method


def _fails(entry: StabilityClass, limit: float) -> bool:
    errors = entry.methods.get(EXACT)
    if errors is None:
        return False
    return (
        errors.not_finite + errors.wrong_by_1_percent > 0 or (errors.largest_over_conditioning or 0) > limit
    )


def _sentence(measured: Stability, method: str) -> str:
    found = [entry.methods[method] for entry in measured.classes if method in entry.methods]
    count = sum(errors.triangles for errors in found)
    largest = max((errors.largest_over_conditioning or 0 for errors in found), default=0.0)
    not_finite, wrong = sum(e.not_finite for e in found), sum(e.wrong_by_1_percent for e in found)
    return (
        f"Over {count:,} triangles {_label(method)} is off by up to {largest:.2g} times the conditioning; {not_finite:,} of its "
        f"values are not finite, {wrong:,} are wrong by more than 1 %."
    )


def _label(method: str) -> str:
    return _LABELS.get(method, method)


def _figure(measured: Stability) -> go.Figure:
    names = [entry.name for entry in measured.classes]
    traces = [guide(f"limit {measured.limit:g}", names, [measured.limit] * len(names))]
    for index, method in enumerate(methods_of(measured)):
        traces += _traces(measured, method, index)
    x = axis("", type="category", tickangle=-40)
    return figure(traces, x, power_axis("error / conditioning", decades=3), height=560, legend=_LEGEND)


def _traces(measured: Stability, method: str, index: int) -> list[go.Scatter]:
    """Plots the largest error of every class and, with small open symbols, its 99th percentile."""
    found = [(entry.name, entry.methods[method]) for entry in measured.classes if method in entry.methods]
    colour, symbol = series_colour(index), _SYMBOLS[index % len(_SYMBOLS)]
    largest = [(name, errors.largest_over_conditioning) for name, errors in found]
    most = [(name, errors.percentile_99_over_conditioning) for name, errors in found]
    return [
        _trace(largest, f"{_label(method)}, largest", {"color": colour, "symbol": symbol, "size": 10}),
        _trace(most, f"{_label(method)}, 99 %", {"color": colour, "symbol": f"{symbol}-open", "size": 7}),
    ]


def _trace(values: list[tuple[str, float | None]], name: str, marker: dict[str, object]) -> go.Scatter:
    # A logarithmic axis has no zero: a class without any error has no point.
    shown = [(where, value) for where, value in values if value]
    return go.Scatter(
        x=[where for where, _ in shown],
        y=[value for _, value in shown],
        mode="markers",
        marker=marker,
        name=name,
        hovertemplate="%{x}: %{y:.3g}<extra>" + name + "</extra>",
    )


def _table(measured: Stability) -> Markup:
    methods = methods_of(measured)
    header = ["class", "triangles"]
    for method in methods:
        header += [f"{method}: largest", "not finite", "wrong"]
    rows = []
    for entry in measured.classes:
        cells = [cell for method in methods for cell in _cells(entry, entry.methods.get(method))]
        rows.append([entry.name, f"{_triangles(entry):,}", *cells])
    return page.table(header, rows)


def _triangles(entry: StabilityClass) -> int:
    return max((errors.triangles for errors in entry.methods.values()), default=0)


def _cells(entry: StabilityClass, errors: MethodErrors | None) -> list[str]:
    """Writes the cells of a method; one that was evaluated for some triangles of a class also says for how many."""
    if errors is None:
        return ["", "", ""]
    largest = errors.largest_over_conditioning
    counts = [f"{errors.not_finite:,}", f"{errors.wrong_by_1_percent:,}"]
    if errors.triangles < _triangles(entry):
        counts = [f"{count} of {errors.triangles:,}" for count in counts]
    return ["" if largest is None else f"{largest:.2g}", *counts]
