"""The parts, colours and axes of all plots."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from html import escape
from typing import Any, TypeVar

import plotly.graph_objects as go

from analysis.results.statistics import grouped

# Okabe and Ito's palette, which colour-blind readers can distinguish; the symbols do the same in grey print.
_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
_SYMBOLS = ("circle", "square", "diamond", "triangle-up", "x", "star", "cross")
_FONT = "system-ui, -apple-system, 'Segoe UI', 'DejaVu Sans', sans-serif"
INK, GRID, SENSOR_COLOUR, TARGET_COLOUR = "#24292f", "#e4e7eb", "#0072B2", "#D55E00"
MACHINE_COLOUR = "#9aa4ae"

_Item = TypeVar("_Item")


@dataclass(frozen=True, eq=False)
class Panel:
    """One figure and the line above it."""

    caption: str
    figure: go.Figure


@dataclass(frozen=True, eq=False)
class Plot:
    """A section of the report: a title, one sentence of finding computed from the data, and figures side by side."""

    title: str
    finding: str
    panels: list[Panel]
    explanation: str = ""


def family_marker(family: str, families: list[str], **more: Any) -> dict[str, Any]:
    """Returns the colour and the symbol of a family, or of a machine, the same in every plot."""
    index = families.index(family)
    colour, symbol = _COLOURS[index % len(_COLOURS)], _SYMBOLS[index % len(_SYMBOLS)]
    return {"color": colour, "symbol": symbol, "size": 8, **more}


def series_colour(index: int) -> str:
    """Returns the colour of a series that stands for no family."""
    return _COLOURS[index % len(_COLOURS)]


def axis(title: str, **more: Any) -> dict[str, Any]:
    """Returns an axis with a title that holds the unit."""
    return {
        "title": {"text": title, "standoff": 8},
        "gridcolor": GRID,
        "zerolinecolor": "#9aa4ae",
        "linecolor": "#9aa4ae",
        "showline": True,
        "ticks": "outside",
        "tickcolor": "#9aa4ae",
        "automargin": True,
        **more,
    }


def log_axis(title: str, **more: Any) -> dict[str, Any]:
    """Returns a logarithmic axis whose ticks are powers of ten with 2 and 5 between, written out."""
    ticks = [digit * 10.0**exponent for exponent in range(-6, 7) for digit in (1, 2, 5)]
    return axis(title, type="log", tickvals=ticks, ticktext=[f"{tick:g}" for tick in ticks], **more)


def power_axis(title: str, **more: Any) -> dict[str, Any]:
    """Returns a logarithmic axis over many decades, whose ticks are powers of ten."""
    return axis(title, type="log", tick0=0, dtick=1, exponentformat="power", **more)


def rows_axis(names: list[str]) -> dict[str, Any]:
    """Returns the axis of named rows, the first on top."""
    return axis("", type="category", categoryarray=names[::-1], categoryorder="array")


def boxes(points: list[tuple[str, float, str]], name: str, colour: str) -> go.Box:
    """Returns a box for each row, with all points: each has its row, its value, and what it is called."""
    return go.Box(
        x=[value for _, value, _ in points],
        y=[row for row, _, _ in points],
        text=[text for _, _, text in points],
        orientation="h",
        boxpoints="all",
        pointpos=0,
        marker={"color": colour, "size": 4},
        line={"width": 1.2},
        name=name,
        hovertemplate="%{x:.4g}<br>%{text}<extra>" + name + "</extra>",
    )


def guide(name: str, x: Any, y: Any, **line: Any) -> go.Scatter:
    """Returns a line that points are held against, which says nothing of its own; it is dotted unless its style says otherwise."""
    style = {"color": INK, "dash": "dot", "width": 1.5, **line}
    return go.Scatter(x=x, y=y, mode="lines", line=style, name=name, hoverinfo="skip")


def joined(name: str, x: Any, y: Any, colour: str, hover: str, bars: Any = None, **more: Any) -> go.Scatter:
    """Returns points joined by lines, with error bars if given; `hover` is what a point shows beside the name. More is `dash`, or what plotly
    calls it."""
    line = {"color": colour, "dash": more.pop("dash", "solid"), "width": 2}
    shown: dict[str, Any] = {"mode": "lines+markers", "line": line, **more}
    marker = shown.pop("marker", {"color": colour, "size": 6})
    return marks(name, x, y, marker, hover, bars, **shown)


def marks(
    name: str, x: Any, y: Any, marker: dict[str, Any], hover: str, bars: Any = None, **more: Any
) -> go.Scatter:
    """Returns points, with error bars if given; `hover` is what a point shows beside the name unless it says so itself, in `<extra>`. More is
    what plotly calls it."""
    told = hover if "<extra>" in hover else f"{hover}<extra>{escape(name)}</extra>"
    if bars is not None:
        more["error_y"] = {"array": bars, "thickness": 1.5}
    return go.Scatter(x=x, y=y, name=name, hovertemplate=told, **{"mode": "markers", "marker": marker} | more)


def by_family(
    items: Iterable[_Item],
    family: Callable[[_Item], str],
    hover: str,
    size: int = 8,
    families: list[str] | None = None,
    **shown: Callable[[_Item], Any],
) -> list[go.Scatter]:
    """Returns points for each family in its colour and symbol, in the order of all `families` if given; `shown` tells what of an item are `x`
    and `y`, and what else plotly knows, such as `customdata`."""
    members = {name: list[_Item]() for name in families or ()} | grouped(items, family)
    names = list(members)
    return [
        marks(name, marker=family_marker(name, names, size=size), hover=hover, **values)
        for name, own in members.items()
        for values in [{what: list(map(of, own)) for what, of in shown.items()}]
    ]


def figure(
    traces: list[Any], x: dict[str, Any], y: dict[str, Any], height: int = 400, **more: Any
) -> go.Figure:
    """Returns a figure in the report's style; the legend lies below, where a narrow screen has room."""
    layout = {
        "font": {"family": _FONT, "size": 13, "color": INK},
        "plot_bgcolor": "white",
        "paper_bgcolor": "white",
        "margin": {"l": 56, "r": 16, "t": 12, "b": 48},
        "height": height,
        "legend": {"orientation": "h", "y": -0.22, "yanchor": "top", "x": 0, "xanchor": "left"},
        "hoverlabel": {"font": {"family": _FONT}},
        "xaxis": x,
        "yaxis": y,
    }
    return go.Figure(data=traces, layout=layout | more)
