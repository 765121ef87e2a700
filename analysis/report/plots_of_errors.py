"""The model held against the reference: value against value, and the error over what describes a set-up."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import plotly.graph_objects as go

from analysis.report.plot import Panel, Plot, axis, by_family, family_marker, figure, guide, log_axis, marks
from analysis.results.study_results import COMPARED_METHOD
from analysis.results.set_up import SetUp
from analysis.results.table import CHANGE, DELTA_SELF, MUTUAL, QUANTITIES, Row, compared
from analysis.results.units import in_words, too
from geometries.common.measured import PICOFARAD
from geometries.studies.machines import NONE

TITLE = "Model error in the change of a reading"
_ALONE = "no machine"
_EXPLANATION = (
    "Each point is a reading, a sensor, or a sensor and a target. The change is the reading with the targets less that without them. "
    "Where nothing stays but the sensor, driven by itself, it is delta_self, and one row of the table stands for both. Bars: the "
    "reference's own error carried over."
)


def error_of_changes(rows: list[Row]) -> Plot:
    """Plots the model error of changes over the changes, by machine; mutual and delta_self beside it. Needs one compared change."""
    known = compared(rows)
    machines = sorted(dict.fromkeys(row.machine for row in known), key=lambda machine: machine == NONE)
    changes = [row for row in known if row.is_change]
    caption = "change of the reading, delta_self where there is no machine"
    panels = [Panel(caption, _errors_of_changes(changes, "change", machines))]
    # Without machines the change is nothing but delta_self.
    beside = (MUTUAL, DELTA_SELF) if any(row.quantity == CHANGE for row in known) else (MUTUAL,)
    for quantity in beside:
        own = [row for row in known if row.quantity == quantity]
        if own:
            panels.append(Panel(quantity, _errors_of_changes(own, quantity, machines)))
    return Plot(TITLE, _finding_on_changes(changes, machines, rows), panels, _EXPLANATION)


def _finding_on_changes(changes: list[Row], machines: list[str], rows: list[Row]) -> str:
    phrases = []
    for machine in machines:
        errors = [row.model_error for row in changes if row.machine == machine]
        if errors:
            where = "without a machine" if machine == NONE else f"with {machine}"
            among = f"median of {len(errors)}, {too(min(errors))} to {too(max(errors))}"
            phrases.append(f"{too(float(np.median(errors)))} {where} ({among if errors[1:] else 'one case'})")
    unknown = sum(row.is_change and not row.is_compared for row in rows)
    left_out = f" The model knows no value of {unknown} more." if unknown else ""
    return f"In the change of a reading the model is {', '.join(phrases)}.{left_out}"


def _errors_of_changes(rows: list[Row], what: str, machines: list[str]) -> go.Figure:
    points = [(row.reference.value / PICOFARAD, row) for row in rows]
    names = {machine: _ALONE if machine == NONE else machine for machine in machines}
    return _errors(points, lambda row: row.machine, names, what, log_axis(f"{what} by the reference (pF)"))


def _errors(
    points: list[tuple[float, Row]],
    group: Callable[[Row], str],
    names: dict[str, str],
    what: str,
    x: dict[str, Any],
) -> go.Figure:
    """Plots the model errors of rows over numbers, each group of rows, whose names are given, in its own colour."""
    traces = []
    for each, name in names.items():
        own = [(at, row) for at, row in points if group(row) == each]
        if own:
            traces.append(error_points(own, name, family_marker(each, list(names))))
    return figure(traces, x, axis(f"model error in {what} (%)", zeroline=True, zerolinewidth=2))


PERCENT = 100.0


def model_against_reference(rows: list[Row]) -> Plot:
    """Plots the model's values over the reference's, with error bars; on the diagonal they agree."""
    present = _quantities(rows)
    panels = [Panel(quantity, _values(rows, quantity)) for quantity in present]
    shares = []
    for quantity in present:
        ratios = sorted(1 + row.model_error for row in rows if row.quantity == quantity)
        middle = f"{ratios[0]:.2f} to {ratios[-1]:.2f} times (median {float(np.median(ratios)):.2f})"
        shares.append(f"{middle} the reference's value of {quantity}")
    return Plot(
        "Model against reference",
        f"The exact model's value is {' and '.join(shares)}.",
        panels,
        "Each point is a case; on the line both agree. Horizontal bars: the reference's own error.",
    )


def _quantities(rows: list[Row]) -> list[str]:
    """Returns the quantities that any row is of."""
    return [quantity for quantity in QUANTITIES if any(row.quantity == quantity for row in rows)]


def _values(rows: list[Row], quantity: str) -> go.Figure:
    chosen = [row for row in rows if row.quantity == quantity]
    both = ((row.reference.value, row.model[COMPARED_METHOD]) for row in chosen)
    every = [value / PICOFARAD for values in both for value in values]
    positive = [value for value in every if 0 < value < math.inf]
    ends = [min(positive) / 1.5, max(positive) * 1.5]
    points = by_family(
        chosen,
        lambda row: row.case.family,
        "%{text}<br>reference %{x:.5g} pF, model %{y:.5g} pF<extra></extra>",
        families=list(dict.fromkeys(row.case.family for row in rows)),
        x=lambda row: row.reference.value / PICOFARAD,
        y=lambda row: row.model[COMPARED_METHOD] / PICOFARAD,
        text=hover_text,
        customdata=lambda row: row.case.id,
    )
    for trace in points:
        bars = [row.reference.error / PICOFARAD for row in chosen if row.case.family == trace.name]
        trace.update(error_x={"array": bars, "thickness": 1.5})
    traces = [guide("both agree", ends, ends), *points]
    return figure(traces, log_axis(f"reference: {quantity} (pF)"), log_axis(f"model for {quantity} (pF)"))


def hover_text(row: Row) -> str:
    """Returns what a point shows of its case."""
    return f"{row.case.name}<br>{in_words(row.case.parameters)}"


def errors_over_set_ups(rows: list[Row]) -> list[Plot]:
    """Plots the model error over each number that describes one plate before another; lengths are in sensor sizes."""
    offset = axis("lateral offset of the centres over sensor size", zeroline=False)
    return [
        _error_over(rows, "gap/size", log_axis("gap over sensor size"), lambda s: s.gap_over_size),
        _error_over(rows, "tilt", axis("tilt (degrees)", zeroline=False), lambda s: s.tilt_degrees),
        _error_over(rows, "lateral offset", offset, lambda s: s.lateral_offset_over_size),
        _error_over(rows, "size ratio", log_axis("target size over sensor size"), lambda s: s.size_ratio),
    ]


def _error_over(rows: list[Row], name: str, x: dict[str, Any], value: Callable[[SetUp], float]) -> Plot:
    described = [(value(row.set_up), row) for row in rows if row.set_up is not None]
    described.sort(key=lambda point: point[0])
    families = {row.case.family: row.case.family for row in rows if row.set_up is not None}
    panels = []
    for quantity in _quantities([row for _, row in described]):
        points = [(at, row) for at, row in described if row.quantity == quantity]
        panels.append(Panel(quantity, _errors(points, lambda row: row.case.family, families, quantity, x)))
    return Plot(f"Model error over {name}", _finding(described, name), panels)


def error_points(points: list[tuple[float, Row]], name: str, marker: dict[str, Any]) -> go.Scatter:
    """Returns points of model errors in percent over numbers, with the reference's own error as their bars."""
    at, rows = zip(*points)
    errors = [row.model_error for row in rows]
    ends = [row.model_error_interval for row in rows]
    hover = "%{text}<br>model error %{y:+.2f} %<extra></extra>"
    bars = {
        "symmetric": False,
        "array": [PERCENT * (high - error) for (_, high), error in zip(ends, errors)],
        "arrayminus": [PERCENT * (error - low) for (low, _), error in zip(ends, errors)],
        "thickness": 1.5,
    }
    more = {"text": list(map(hover_text, rows)), "customdata": [row.case.id for row in rows]}
    return marks(name, list(at), [PERCENT * error for error in errors], marker, hover, error_y=bars, **more)


def _finding(described: list[tuple[float, Row]], name: str) -> str:
    """Compares the median error of the lowest third with that of the highest; if most abscissae are equal, of those below and above."""
    if len({x for x, _ in described}) < 2:
        return f"All cases of this study have the same {name}."
    ordered = sorted(x for x, _ in described)
    low, high = ordered[(len(ordered) - 1) // 3], ordered[-1 - (len(ordered) - 1) // 3]
    if low == high:
        low = max((x for x in ordered if x < low), default=low)
        high = min((x for x in ordered if x > high), default=high)
    changes = []
    for quantity in _quantities([row for _, row in described]):
        below = [row.model_error for x, row in described if row.quantity == quantity and x <= low]
        above = [row.model_error for x, row in described if row.quantity == quantity and x >= high]
        changes.append(f"from {too(float(np.median(below)))} to {too(float(np.median(above)))} in {quantity}")
    return (
        f"Between the cases whose {name} is at most {low:.3g} and those where it is at least {high:.3g}, the median of the "
        f"model goes {' and '.join(changes)}."
    )
