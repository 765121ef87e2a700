"""The first figure of a report: the model's error in the change of a reading, which is what the electronics notice."""

from __future__ import annotations

import numpy as np
import plotly.graph_objects as go

from analysis.report.plot import Panel, Plot, axis, family_marker, figure, log_axis
from analysis.report.plots_of_errors import error_points
from analysis.results.table import CHANGE, DELTA_SELF, MUTUAL, Row, compared
from analysis.results.units import PICOFARAD, too
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
    panels = [
        Panel(
            "change of the reading, delta_self where there is no machine",
            _errors(changes, "change", machines),
        )
    ]
    # Without machines the change is nothing but delta_self.
    beside = (MUTUAL, DELTA_SELF) if any(row.quantity == CHANGE for row in known) else (MUTUAL,)
    for quantity in beside:
        own = [row for row in known if row.quantity == quantity]
        if own:
            panels.append(Panel(quantity, _errors(own, quantity, machines)))
    return Plot(TITLE, _finding(changes, machines, rows), panels, _EXPLANATION)


def _finding(changes: list[Row], machines: list[str], rows: list[Row]) -> str:
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


def _label(machine: str) -> str:
    return _ALONE if machine == NONE else machine


def _errors(rows: list[Row], what: str, machines: list[str]) -> go.Figure:
    traces = []
    for machine in machines:
        members = [row for row in rows if row.machine == machine]
        if not members:
            continue
        at = [row.reference.value / PICOFARAD for row in members]
        traces.append(error_points(at, members, _label(machine), family_marker(machine, machines)))
    y = axis(f"model error in {what} (%)", zeroline=True, zerolinewidth=2)
    return figure(traces, log_axis(f"{what} by the reference (pF)"), y)
