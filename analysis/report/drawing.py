"""Small drawings of scenes, as SVG, which needs no script: the set-ups on the first page of a report."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from analysis.report.plot import SENSOR_COLOUR
from analysis.report.plots_in_space import EYE, colours, triangles
from geometries.scene.scene import Scene

Array = NDArray[np.float64]

WIDTH, HEIGHT = 220, 140
MARGIN = 8
_PIECES = 5
"""Bodies are cut until no edge is longer than this part of the scene. The painter's algorithm, which draws pieces from back to front, then
hides what is hidden also where a large body stands beside a small one."""
_LIGHT = np.array([0.35, -0.55, 0.76])
_DARKEST = 0.62


def of_scene(scene: Scene, label: str) -> Markup:
    """Draws a scene as the figures in space show it: sensors blue, targets orange, the machine grey. `label` describes it in words."""
    colour_of = colours(scene, SENSOR_COLOUR)
    bodies = triangles(scene)
    everything = np.concatenate(list(bodies.values()))
    longest = float(np.ptp(everything.reshape(-1, 3), axis=0).max()) / _PIECES
    pieces, paint = [], []
    for name, own in bodies.items():
        small = cut(own, longest)
        pieces.append(small)
        paint += [_shaded(colour_of[name], triangle) for triangle in small]
    corners = np.concatenate(pieces)
    towards, across, up = _axes()
    depth = (corners @ towards).mean(axis=1)
    flat = fitted(np.stack([corners @ across, -(corners @ up)], axis=-1))
    polygons = []
    for index in np.argsort(depth):
        points = " ".join(f"{x:.1f},{y:.1f}" for x, y in flat[index])
        polygons.append(
            Markup('<polygon points="{}" fill="{}" stroke="{}"/>').format(points, *2 * [paint[index]])
        )
    return svg(polygons, label)


def cut(corners: Array, longest: float) -> Array:
    """Bisects the longest edges of triangles (n, 3, 3) until none is longer than `longest`."""
    while True:
        edges = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
        long = edges.max(axis=1) > longest
        if not long.any():
            return corners
        own, first = corners[long], edges[long].argmax(axis=1)
        rows = np.arange(len(own))
        a, b, c = (own[rows, (first + step) % 3] for step in range(3))
        middle = (a + b) / 2
        halves = [np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)]
        corners = np.concatenate([corners[~long], *halves])


def _axes() -> tuple[Array, Array, Array]:
    """Returns the directions towards the eye, to the right and up."""
    towards = np.array(EYE) / np.linalg.norm(EYE)
    across = np.cross([0.0, 0.0, 1.0], towards)
    across /= np.linalg.norm(across)
    return towards, across, np.cross(towards, across)


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
