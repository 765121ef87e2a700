"""Figures of the error's parts: stacked bars by kind of set-up, and maps of the model's error."""

from __future__ import annotations

import numpy as np
import plotly.graph_objects as go

from analysis.report.plot import INK, Panel, axis, figure, series_colour
from analysis.results.table import DELTA_SELF
from analysis.topics.errors import parts
from analysis.topics.errors.records import Entry
from analysis.topics.errors.set_ups import DEFAULT, OFFSET_MAP, SIZE_MAP, TILT_MAP

PERCENT = 100.0
# A part has the same colour for both quantities.
_ALL_PARTS = parts.PARTS[DELTA_SELF]
_CLIPPED = 100.0
"""Error (per cent) at the end of a map's colour scale; larger errors have the same colour."""
_ACROSS = {
    SIZE_MAP: "target size over sensor size",
    TILT_MAP: "tilt (degrees)",
    OFFSET_MAP: "lateral offset over sensor size",
}


def bars(caption: str, found: list[Entry], quantity: str) -> Panel:
    """Returns the mean of each part by kind of set-up, stacked; together they are the mean error, which is marked."""
    kinds = list(dict.fromkeys(kind(entry) for entry in found))
    members = {name: [entry for entry in found if kind(entry) == name] for name in kinds}
    traces: list[object] = []
    for part in parts.PARTS[quantity]:
        means = [PERCENT * np.mean([e.parts(quantity)[part] for e in members[name]]) for name in kinds]
        traces.append(
            go.Bar(
                x=kinds,
                y=means,
                name=part,
                marker={"color": series_colour(_ALL_PARTS.index(part))},
                hovertemplate="%{x}: %{y:+.1f} %<extra>" + part + "</extra>",
            )
        )
    errors = [PERCENT * np.mean([entry.error(quantity) for entry in members[name]]) for name in kinds]
    traces.append(
        go.Scatter(
            x=kinds,
            y=errors,
            mode="markers",
            marker={"color": INK, "symbol": "line-ew-open", "size": 22, "line": {"width": 3}},
            name="their sum: the model's mean error",
            hovertemplate="%{x}: %{y:+.1f} %<extra>mean error</extra>",
        )
    )
    x = axis("", type="category", tickangle=-40)
    y = axis(f"part of the error in {quantity} (%)", zeroline=True, zerolinewidth=2)
    # The legend lies elsewhere, because the names of the bars need its usual place.
    legend = {"orientation": "h", "y": 1.02, "yanchor": "bottom", "x": 0, "xanchor": "left"}
    return Panel(caption, figure(traces, x, y, height=520, barmode="relative", legend=legend))


def kind(entry: Entry) -> str:
    """Returns the family of a set-up of the default study, else its group."""
    return entry.set_up.family if entry.set_up.group == DEFAULT else entry.set_up.group


def error_map(group: str, found: list[Entry], quantity: str) -> Panel:
    """Plots the model's error over gap and the map's other axis; a click opens the set-up."""
    shown = [entry for entry in found if entry.set_up.group == group]
    places = [entry.set_up.place or (0.0, 0.0) for entry in shown]
    gaps, across = (sorted({place[axis_] for place in places}) for axis_ in (0, 1))
    values = np.full((len(gaps), len(across)), np.nan)
    texts, cases = np.full(values.shape, "", dtype=object), np.full(values.shape, "", dtype=object)
    annotations = []
    for entry, (gap, other) in zip(shown, places):
        row, column = gaps.index(gap), across.index(other)
        values[row, column] = PERCENT * entry.error(quantity)
        texts[row, column] = _hover_text(entry, quantity)
        cases[row, column] = entry.set_up.id
        annotations.append(_number(column, row, float(values[row, column])))
    trace = go.Heatmap(
        x=[f"{value:g}" for value in across],
        y=[f"{gap:g}" for gap in gaps],
        z=np.clip(values, -_CLIPPED, _CLIPPED),
        zmin=-_CLIPPED,
        zmax=_CLIPPED,
        colorscale="RdBu",
        reversescale=True,
        customdata=cases,
        text=texts,
        hovertemplate="%{text}<extra></extra>",
        colorbar={"title": "%", "thickness": 12},
        xgap=1,
        ygap=1,
    )
    x, y = axis(_ACROSS[group], type="category"), axis("gap over sensor size", type="category")
    return Panel(f"model error in {quantity} (%)", figure([trace], x, y, height=420, annotations=annotations))


def _hover_text(entry: Entry, quantity: str) -> str:
    lines = [f"model error {PERCENT * entry.error(quantity):+.1f} %, of it"]
    lines += [
        f"{name} {PERCENT * value:+.1f}" for name, value in entry.parts(quantity).items() if abs(value) > 5e-4
    ]
    return "<br>".join(lines)


def _number(column: int, row: int, value: float) -> dict[str, object]:
    """Writes the number in its cell of the map, light on dark."""
    colour = "white" if abs(value) > 0.6 * _CLIPPED else INK
    return {
        "x": column,
        "y": row,
        "text": f"{round(value) + 0.0:+.0f}",
        "showarrow": False,
        "font": {"size": 11, "color": colour},
    }
