"""Small drawings for pages: of a scene, and of a figure."""

import math
from typing import Any

import numpy as np
from markupsafe import Markup

from analysis.report.plot import GRID, SENSOR_COLOUR
from analysis.report.plots_in_space import EYE, colours, cut, triangles
from geometries.common.arrays import Array
from geometries.scene.scene import Scene

WIDTH, HEIGHT = 220, 140
MARGIN = 8
_PIECES = 5
"""Bodies are cut until no edge is longer than this part of the scene. The painter's algorithm, which draws pieces from back to front, then
hides what is hidden also where a large body stands beside a small one."""
_LIGHT = np.array([0.35, -0.55, 0.76])
_DARKEST = 0.62


def of_scene(scene: Scene, label: str) -> Markup:
    """Draws a scene as the figures in space show it: sensors blue, targets orange, the machine grey. `label` describes it in words."""
    colour_of, bodies = colours(scene, SENSOR_COLOUR), triangles(scene)
    everything = np.concatenate(list(bodies.values()))
    longest = float(np.ptp(everything.reshape(-1, 3), axis=0).max()) / _PIECES
    pieces, paint = [], []
    for name, own in bodies.items():
        small = cut(own, longest)
        pieces.append(small)
        paint += [_shaded(colour_of[name], triangle) for triangle in small]
    corners = np.concatenate(pieces)
    # The directions towards the eye, to the right and up.
    towards, across = np.array(EYE) / np.linalg.norm(EYE), np.cross([0.0, 0.0, 1.0], EYE)
    across /= np.linalg.norm(across)
    up = np.cross(towards, across)
    depth = (corners @ towards).mean(axis=1)
    flat = fitted(np.stack([corners @ across, -(corners @ up)], axis=-1))
    polygons = []
    for index in np.argsort(depth):
        shape = Markup('<polygon points="{}" fill="{}" stroke="{}"/>')
        polygons.append(shape.format(_written(flat[index]), *2 * [paint[index]]))
    return svg(polygons, label)


def _written(points: Array) -> str:
    """Returns points (n, 2) as SVG has them."""
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def fitted(points: Array, keep_aspect: bool = True) -> Array:
    """Moves and scales points (…, 2), downwards the second, into the drawing."""
    low, high = points.reshape(-1, 2).min(axis=0), points.reshape(-1, 2).max(axis=0)
    room = np.array([WIDTH, HEIGHT]) - 2 * MARGIN
    scale = room / np.maximum(high - low, 1e-300)
    scale = np.full(2, scale.min()) if keep_aspect else np.where(high > low, scale, 0.0)
    return np.asarray((points - (low + high) / 2) * scale + np.array([WIDTH, HEIGHT]) / 2)


def _shaded(colour: str, triangle: Array) -> str:
    """Returns a colour as a matt surface shows it; both sides of a sheet look the same."""
    normal = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
    length = float(np.linalg.norm(normal))
    facing = abs(float(normal @ _LIGHT)) / length if length > 0 else 1.0
    light = _DARKEST + (1 - _DARKEST) * facing
    return "#" + "".join(f"{round(int(colour[at : at + 2], 16) * light):02x}" for at in (1, 3, 5))


def svg(parts: list[Markup], label: str) -> Markup:
    """Returns a drawing of elements; `label` says in words what it shows."""
    head = Markup(
        '<svg class="drawing" role="img" aria-label="{}" viewBox="0 0 {} {}" stroke-width="0.6" stroke-linejoin="round">'
    )
    return head.format(label, WIDTH, HEIGHT) + Markup("").join(parts) + Markup("</svg>")


Trace = dict[str, Any]

_DRAWN = ("scatter", "bar")
_RADIUS = 2.2
_MARKS = 300
"""Marks of one trace at most; of more, every second, third … is drawn."""


def thumbnail(data: list[Trace], layout: dict[str, Any], label: str) -> Markup:
    """Draws the points, lines and bars of a figure of plotly, given as its JSON, without axes; empty if it has none of them."""
    drawn = [(trace, points) for trace, points in _all_points(data, layout) if len(points)]
    if not drawn:
        return Markup("")
    whole = fitted(np.concatenate([points for _, points in drawn]) * np.array([1.0, -1.0]), keep_aspect=False)
    placed = np.split(whole, np.cumsum([len(points) for _, points in drawn]))
    line = Markup('<path class="axes" d="M{0},{0}V{1}H{2}" fill="none" stroke="{3}" stroke-width="1.5"/>')
    parts = [line.format(MARGIN / 2, HEIGHT - MARGIN / 2, WIDTH - MARGIN / 2, GRID)]
    for (trace, _), own in zip(drawn, placed):
        parts += _bars(trace, own) if trace.get("type") == "bar" else _marks(trace, own)
    return svg(parts, label)


def _all_points(data: list[Trace], layout: dict[str, Any]) -> list[tuple[Trace, Array]]:
    """Returns the points (n, 2) of each trace; a bar has two, its ends. Bars stand on those before them, as in a stacked figure."""
    found = []
    stacked: dict[tuple[float, bool], float] = {}
    for trace in (trace for trace in data if trace.get("type", "scatter") in _DRAWN):
        points = _points(trace, layout)
        if trace.get("type") == "bar":
            ends = []
            for x, height in points:
                start = stacked.get((x, height >= 0), 0.0)
                stacked[x, height >= 0] = start + height
                ends += [(x, start), (x, start + height)]
            points = np.array(ends).reshape(-1, 2)
        found.append((trace, points))
    return found


def _points(trace: Trace, layout: dict[str, Any]) -> Array:
    """Returns the finite points (n, 2) of a trace on the scales of its axes; names, as of bars, are numbered."""
    columns = []
    for name in ("x", "y"):
        values = trace.get(name) or []
        if any(isinstance(value, str) for value in values):
            values = list(range(len(values)))
        numbers = np.array([math.nan if value is None else float(value) for value in values])
        if layout.get(f"{name}axis", {}).get("type") == "log":
            numbers = np.log10(np.where(numbers > 0, numbers, math.nan))
        columns.append(numbers)
    if len(columns[0]) != len(columns[1]):
        return np.empty((0, 2))
    both = np.stack(columns, axis=-1)
    return np.asarray(both[np.isfinite(both).all(axis=1)])


def _colour(trace: Trace, part: str) -> str:
    colour = trace.get(part, {}).get("color")
    return colour if isinstance(colour, str) else SENSOR_COLOUR


def _marks(trace: Trace, points: Array) -> list[Markup]:
    parts = []
    if "lines" in trace.get("mode", "lines"):
        line = Markup('<polyline points="{}" fill="none" stroke="{}" stroke-width="1.5"/>')
        parts.append(line.format(_written(points), _colour(trace, "line")))
    if "markers" in trace.get("mode", ""):
        step, colour = math.ceil(len(points) / _MARKS), _colour(trace, "marker")
        mark = Markup('<circle cx="{}" cy="{}" r="{}" fill="{}"/>')
        parts += [mark.format(f"{x:.1f}", f"{y:.1f}", _RADIUS, colour) for x, y in points[::step]]
    return parts


def _bars(trace: Trace, ends: Array) -> list[Markup]:
    width = 1.4 * (WIDTH - 2 * MARGIN) / len(ends)
    bar = Markup('<rect x="{}" y="{}" width="{}" height="{}" fill="{}"/>')
    parts = []
    for (x, y), (_, end) in zip(ends[::2], ends[1::2]):
        numbers = (f"{number:.1f}" for number in (x - width / 2, min(y, end), width, abs(end - y)))
        parts.append(bar.format(*numbers, _colour(trace, "marker")))
    return parts
