"""Draws the figures of the notes: python3 -m analysis measure figures [FOLDER].

Every figure is an SVG file beside the note that shows it, or in FOLDER if one is given. Its colours are of middle brightness and its
background is transparent, so that it can be read on white and on black.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from numpy.typing import NDArray

from geometries.common.installation import ROOT

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend is chosen first)

Array = NDArray[np.float64]

INK = "#7d8590"
BLUE = "#3987d6"
ORANGE = "#d9742b"
GREEN = "#2f9e6a"
RED = "#d4483f"
_STYLE: dict[str, Any] = {
    "svg.hashsalt": "fringe",
    "svg.fonttype": "none",
    "font.family": "sans-serif",
    "font.size": 10,
    "text.color": INK,
    "axes.edgecolor": INK,
    "lines.linewidth": 1.4,
    "savefig.transparent": True,
}


def _axes(width: float, height: float, columns: int = 1) -> tuple[Any, list[Any]]:
    """A figure of the given size in inches with drawings side by side, each with equal scales and no frame."""
    figure, axes = plt.subplots(1, columns, figsize=(width, height), squeeze=False)
    for one in axes[0]:
        one.set_aspect("equal")
        one.axis("off")
    figure.subplots_adjust(left=0.01, right=0.99, bottom=0.01, top=0.99, wspace=0.02)
    return figure, list(axes[0])


def _polygon(
    axes: Any, points: Sequence[Any] | Array, colour: str, fill: float = 0.2, **options: Any
) -> None:
    closed = np.array([*points, points[0]], dtype=float)
    if fill:
        axes.fill(closed[:, 0], closed[:, 1], color=colour, alpha=fill, linewidth=0)
    axes.plot(closed[:, 0], closed[:, 1], color=colour, **options)


def _line(axes: Any, points: Sequence[Any] | Array, colour: str, **options: Any) -> None:
    array = np.array(points, dtype=float)
    axes.plot(array[:, 0], array[:, 1], color=colour, **options)


def _dots(axes: Any, points: Sequence[Any] | Array, colour: str, size: float = 4) -> None:
    array = np.array(points, dtype=float)
    axes.plot(array[:, 0], array[:, 1], "o", color=colour, markersize=size)


def _arrow(axes: Any, start: Sequence[float] | Array, end: Sequence[float] | Array, colour: str) -> None:
    axes.annotate("", xy=end, xytext=start, arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.2})


def nine_cells() -> Any:
    """The plate from above: the four planes on its edges cut space into nine cells, and a triangle into pieces."""
    figure, (axes,) = _axes(4.6, 3.6)
    length, width, margin = 2.0, 1.4, 1.1
    _polygon(axes, [(0, 0), (length, 0), (length, width), (0, width)], BLUE, 0.25, linewidth=2)
    for x in (0, length):
        _line(axes, [(x, -margin), (x, width + margin)], INK, linestyle="--", linewidth=0.8)
    for y in (0, width):
        _line(axes, [(-margin, y), (length + margin, y)], INK, linestyle="--", linewidth=0.8)
    for x in (-0.55, 0.25, length + 0.55):
        for y in (-0.55, 0.25, width + 0.55):
            beside = (not 0 < x < length) + (not 0 < y < width)
            axes.text(x, y, ("I", "II", "III")[beside], ha="center", va="center", fontsize=12)
    triangle = [(0.75, 0.55), (2.75, 1.0), (1.6, 2.2)]
    _polygon(axes, triangle, ORANGE, 0.3)
    for point, nearest in (((2.45, 1.08), (length, 1.08)), ((1.62, 1.85), (1.62, width))):
        _arrow(axes, nearest, point, GREEN)
    _arrow(axes, (length, width), (2.2, 1.58), GREEN)
    _dots(axes, [(1.35, 0.95)], GREEN)
    axes.text(1.3, 0.95, "v = (0, 0, z)", color=GREEN, va="center", ha="right", fontsize=8)
    axes.text(length / 2, 0.06, "plate", color=BLUE, ha="center", va="bottom")
    axes.text(1.6, 2.28, "triangle", color=ORANGE, ha="center", va="bottom")
    return figure


def virtual_triangle() -> Any:
    """A triangle beside an edge, and the virtual triangle of the vectors from the plate's nearest points to its vertices."""
    figure, (left, right) = _axes(7.2, 2.9, 2)

    def seen(point: Sequence[float] | Array) -> Array:
        """A parallel projection of space: x to the right, z up, y backwards."""
        x, y, z = point
        return np.array([x + 0.3 * y, z + 0.42 * y])

    corners = np.array([(1.1, 0.2, 0.5), (2.9, 1.3, 0.45), (1.5, 2.7, 1.45)])
    _polygon(left, [seen(p) for p in ((-1.3, 0, 0), (0, 0, 0), (0, 3.0, 0), (-1.3, 3.0, 0))], BLUE, 0.25)
    left.text(*seen((-0.75, 1.3, 0)), "plate", color=BLUE, ha="center", va="center")
    _polygon(left, [seen(p) for p in corners], ORANGE, 0.3)
    for k, corner in enumerate(corners):
        foot = np.array([0, corner[1], 0])
        _arrow(left, seen(foot), seen(corner), GREEN)
        _dots(left, [seen(foot)], GREEN, 3)
        left.text(*(seen(0.45 * foot + 0.55 * corner) + [0, (-0.22, 0.1, 0.18)[k]]), f"$v_{k}$", color=GREEN)
    left.text(*(seen(corners[2]) + [0.15, 0]), "T", color=ORANGE)
    left.set_xlim(-1.4, 3.6)
    left.set_ylim(-0.4, 3.1)

    # v is (x, 0, z) in region II: the virtual triangle lies in a plane through the origin.
    a, b, m = (corners[k, [0, 2]] for k in (0, 1, 2))
    foot = a + np.dot(m - a, b - a) / np.dot(b - a, b - a) * (b - a)
    _polygon(right, [a, b, m], ORANGE, 0.3)
    _line(right, [m, foot], RED, linestyle="--")
    for k, vertex in enumerate((a, b, m)):
        _arrow(right, (0, 0), vertex, GREEN)
        right.text(*(0.5 * vertex + [0, (0.06, -0.2, 0.12)[k]]), f"$v_{k}$", color=GREEN, ha="center")
    _dots(right, [(0, 0)], INK, 5)
    _dots(right, [foot], RED)
    for name, point, shift in (
        ("0", (0, 0), (-0.14, 0)),
        ("a", a, (0.05, -0.17)),
        ("b", b, (0.14, 0)),
        ("m", m, (0, 0.14)),
        ("Q", foot, (0.1, -0.15)),
    ):
        right.text(*(np.array(point) + shift), name, style="italic", ha="center", va="center")
    right.text(2.2, 1.45, "virtual triangle", color=ORANGE, ha="left")
    right.set_xlim(-0.5, 3.7)
    right.set_ylim(-0.5, 2.3)
    return figure


def gjk_simplex() -> Any:
    """Two polygons and their difference: the search goes from simplex to simplex towards the origin."""
    figure, (left, right) = _axes(7.2, 3.2, 2)
    a = np.array([(0.0, 0.2), (1.1, 0.0), (1.4, 0.9), (0.5, 1.4)])
    b = np.array([(0.7, 0.6), (1.9, 0.3), (1.7, 1.5)])
    _polygon(left, a, BLUE)
    _polygon(left, b, ORANGE)
    left.text(0.35, 0.6, "A", color=BLUE)
    left.text(1.6, 0.75, "B", color=ORANGE)
    left.set_xlim(-0.6, 2.5)
    left.set_ylim(-0.6, 2.1)
    differences = (a[:, None] - b[None]).reshape(-1, 2)
    _polygon(right, _hull(differences), INK, 0.15)
    first = a[0] - b[1]
    second = differences[int(np.argmax(differences @ -first))]
    nearest = _nearest_on_segment(first, second)
    third = differences[int(np.argmax(differences @ -nearest))]
    simplex = [first, second, third]
    _polygon(right, simplex, RED, 0.2)
    for point, name in ((first, "$-v_1$"), (nearest, "$-v_2$")):
        end = point - 0.45 * point / np.linalg.norm(point)
        _arrow(right, point, end, GREEN)
        right.text(*(end + [0.03, -0.05]), name, color=GREEN, ha="left", va="top", fontsize=9)
    _dots(right, [nearest], GREEN, 3)
    _dots(right, simplex, RED)
    for k, point in enumerate(simplex):
        out = point - np.mean(differences, axis=0)
        right.text(
            *(point + 0.18 * out / np.linalg.norm(out)), f"$s_{k + 1}$", color=RED, ha="center", va="center"
        )
    _dots(right, [(0, 0)], INK, 5)
    right.text(0.06, 0.05, "0", ha="left", va="bottom")
    right.text(-0.75, -1.02, "A − B", ha="center")
    right.set_xlim(-2.3, 1.1)
    right.set_ylim(-1.7, 1.3)
    return figure


def _hull(points: Array) -> Array:
    """The corners of the convex hull of points in the plane, anticlockwise."""
    ordered = sorted((float(x), float(y)) for x, y in points)

    def half(sequence: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
        chain: list[tuple[float, float]] = []
        for point in sequence:
            while len(chain) > 1:
                (x0, y0), (x1, y1) = chain[-2], chain[-1]
                if (x1 - x0) * (point[1] - y0) - (y1 - y0) * (point[0] - x0) > 0:
                    break
                chain.pop()
            chain.append(point)
        return chain[:-1]

    return np.array(half(ordered) + half(ordered[::-1]), dtype=np.float64)


def _nearest_on_segment(a: Array, b: Array) -> Array:
    """The point of a segment that is nearest to the origin."""
    share = np.clip(np.dot(-a, b - a) / np.dot(b - a, b - a), 0, 1)
    return np.asarray(a + share * (b - a))


def cone_sensor() -> Any:
    """A section through a distance sensor's cone, and where the point nearest to its apex lies on four surfaces."""
    figure, (axes,) = _axes(5.4, 3.2)
    half_angle, reach = math.radians(30), 3.2
    cap = [(reach * math.sin(t), reach * math.cos(t)) for t in np.linspace(-half_angle, half_angle, 40)]
    _polygon(axes, [(0, 0), *cap], BLUE, 0.15)
    _line(axes, [(0, 0), (0, reach)], BLUE, linestyle="--", linewidth=0.8)
    axes.text(0.05, 0.62, r"$\theta$", color=BLUE)
    axes.text(-0.15, 0.0, "apex", ha="right", va="center", color=BLUE)
    axes.text(0.0, reach + 0.08, "range", color=BLUE, ha="center", va="bottom")
    boundary = np.array([math.sin(half_angle), math.cos(half_angle)])
    left, vertex, right = (
        np.array([(-1.5, 1.75), (-0.1, 1.25)]),
        np.array([(0.15, 2.6), (1.9, 2.75)]),
        np.array([(0.75, 2.0), (1.9, 0.6)]),
    )
    crossing = np.linalg.solve(np.column_stack([boundary, right[0] - right[1]]), right[0])[0] * boundary
    seen = (
        (left, _nearest_on_segment(*left), "foot of the perpendicular", (-1.58, 1.75), "right"),
        (vertex, vertex[0], "vertex", (2.0, 2.75), "left"),
        (right, crossing, "boundary of the cone", (2.0, 0.6), "left"),
    )
    for surface, nearest, name, place, side in seen:
        _line(axes, surface, ORANGE, linewidth=2.2)
        _line(axes, [(0, 0), nearest], GREEN, linewidth=0.8)
        _dots(axes, [nearest], GREEN, 5)
        axes.text(*place, name, ha=side, va="center", fontsize=9)
    _line(axes, [(-2.3, 2.6), (-1.9, 3.3)], ORANGE, linewidth=2.2)
    axes.text(-2.45, 2.9, "outside: not seen", ha="right", va="center", fontsize=9)
    _dots(axes, [(0, 0)], BLUE, 5)
    axes.set_xlim(-4.4, 4.2)
    axes.set_ylim(-0.25, 3.65)
    return figure


def graded_panels() -> Any:
    """A square plate in strips that become narrower towards the edges, each cell cut into two triangles."""
    figure, (axes,) = _axes(3.2, 3.2)
    # The charge grows like r^(-1/2) towards the edge of a thin plate, so the strips' widths go like r^(3/4): their borders like k^4.
    half = 0.5 * (np.arange(6) / 5) ** 4
    borders = np.concatenate([half, 1 - half[-2::-1]])
    lines: list[Any] = []
    for k, border in enumerate(borders):
        lines += [(border, 0), (border, 1), (np.nan, np.nan), (0, border), (1, border), (np.nan, np.nan)]
        for other in range(len(borders) - 1):
            if k + 1 < len(borders):
                falls = (k < 5) != (other < 5)
                low, high = borders[other], borders[other + 1]
                lines += [
                    (border, high if falls else low),
                    (borders[k + 1], low if falls else high),
                    (np.nan, np.nan),
                ]
    axes.fill([0, 1, 1, 0], [0, 0, 1, 1], color=BLUE, alpha=0.15, linewidth=0)
    _line(axes, np.round(lines, 4), BLUE, linewidth=0.6)
    return figure


def quarter_points() -> Any:
    """A section through the mesh at the edge of a plate: graded elements, quarter points next to the edge, middles elsewhere."""
    figure, (axes,) = _axes(4.8, 2.9)
    radii = [0.0, 0.45, 0.75, 1.1]
    angles = np.linspace(0, 2 * math.pi, 9)

    def ring(radius: float) -> Array:
        return radius * np.column_stack([-np.cos(angles), np.sin(angles)])

    _line(axes, [(-2.0, 0), (0, 0)], BLUE, linewidth=4, solid_capstyle="butt")
    axes.text(-1.55, 0.1, "plate", color=BLUE, ha="center")
    sides: list[tuple[Array, Array]] = []
    for inner, outer in zip(radii, radii[1:]):
        near, far = ring(inner), ring(outer)
        for k in range(8):
            sides += [(near[k], far[k]), (far[k], far[k + 1])]
            if inner > 0:
                sides.append((near[k], far[k + 1]))
    for start, end in sides:
        _line(axes, [start, end], INK, linewidth=0.8)
        at_edge = np.allclose(start, 0)
        share = 0.25 if at_edge else 0.5
        _dots(axes, [start + share * (end - start)], RED if at_edge else INK, 3 if at_edge else 2)
    _dots(axes, [(0, 0)], BLUE, 4)
    axes.annotate(
        "nodes at a quarter\nof the side",
        xy=(0.1125, 0.0),
        xytext=(1.3, 0.6),
        color=RED,
        arrowprops={"arrowstyle": "-", "color": RED, "lw": 0.8},
        va="center",
    )
    axes.annotate(
        "nodes half way",
        xy=(0.925, 0.0),
        xytext=(1.3, -0.5),
        arrowprops={"arrowstyle": "-", "color": INK, "lw": 0.8},
        va="center",
    )
    axes.set_xlim(-2.1, 2.9)
    axes.set_ylim(-1.15, 1.15)
    return figure


FIGURES: dict[str, Callable[[], Any]] = {
    "fem_reference/figures/quarter_points.svg": quarter_points,
    "model/figures/cone_sensor.svg": cone_sensor,
    "model/figures/gjk_simplex.svg": gjk_simplex,
    "model/figures/graded_panels.svg": graded_panels,
    "model/figures/nine_cells.svg": nine_cells,
    "model/figures/virtual_triangle.svg": virtual_triangle,
}


def draw(folder: Path) -> list[Path]:
    """Writes every figure to its place in a folder laid out as the repository."""
    written = []
    for name, make in FIGURES.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        with plt.rc_context(_STYLE):
            figure = make()
            figure.savefig(path, format="svg", metadata={"Date": None, "Creator": None})
            plt.close(figure)
        written.append(path)
    return written


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the folder."""
    parser.add_argument("folder", type=Path, nargs="?", default=ROOT)


def measure(options: argparse.Namespace) -> int:
    """Draws the figures and prints their files."""
    for path in draw(options.folder):
        print(path)
    return 0
