"""The report's section on the work for a tenth of an enclosure's width, by adapted meshes and by halved sizes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np
import plotly.graph_objects as go
from markupsafe import Markup

from analysis.report import page
from analysis.report.plot import Panel, axis, figure, power_axis, series_colour
from analysis.results.store import Document

TITLE = "Work for a tenth of an enclosure's width"
COMMAND = "python3 -m analysis measure widths"
_WHAT = (
    "The first mesh leaves a width; a tenth of it is asked for. Adapted meshes are today's: the next one is refined where the gap between the bounds arises, and chosen "
    "to reach the width. Halved sizes are those before: at all edges, from mesh to mesh, with cells that grow more slowly away from edges. All meshes of a set-up count. "
    f"Seconds are those of a processor. Stored measurements; again, from the project's folder: {COMMAND}"
)
Kind = Literal["unknowns", "seconds"]
_SERIES = (("halved", "halved sizes", 1, "diamond"), ("adapted", "adapted", 0, "circle"))


def section(found: Mapping[str, Document]) -> Markup:
    """Returns the finding, unknowns and seconds of every set-up, and every mesh; empty without measurements."""
    if not found:
        return Markup("")
    panels = [Panel(words, _panel(found, kind)) for kind, words in (("unknowns", "unknowns of all meshes"), ("seconds", "processor seconds"))]  # type: ignore[arg-type]  # fmt: skip
    return page.section(
        TITLE,
        page.finding(finding(found)),
        page.figures(panels),
        page.soft(_WHAT),
        page.folded("Every mesh", _table(found)),
    )


def total(meshes: list[Document], kind: Kind) -> float:
    """Returns the unknowns of all meshes together, or the seconds until the end of the last one."""
    return float(sum(mesh["unknowns"] for mesh in meshes) if kind == "unknowns" else meshes[-1]["seconds"])


def reached(answer: Document, series: str) -> bool:
    """Tells whether the last mesh has the width asked for."""
    return bool(answer[series][-1]["width"] <= answer["goal"])


def finding(found: Mapping[str, Document]) -> str:
    """Tells by which factors adapted meshes need less, where both reach the width, and how often halved sizes do not."""
    both = [each for each in found.values() if reached(each, "adapted") and reached(each, "halved")]
    words = f"Adapted meshes reach a tenth of the width in {sum(reached(each, 'adapted') for each in found.values())} of {len(found)} set-ups, halved sizes in {sum(reached(each, 'halved') for each in found.values())}."
    if not both:
        return words
    ratios = {
        kind: [total(each["halved"], kind) / total(each["adapted"], kind) for each in both] for kind in ("unknowns", "seconds")  # type: ignore[arg-type]
    }  # fmt: skip
    spread = {
        kind: f"{np.median(own):.2g} (median, {min(own):.2g} to {max(own):.2g})"
        for kind, own in ratios.items()
    }
    return f"{words} Where both do, halved sizes take {spread['unknowns']} times the unknowns and {spread['seconds']} times the seconds."


def _panel(found: Mapping[str, Document], kind: Kind) -> go.Figure:
    names = list(found)[::-1]
    traces = []
    for series, words, colour, symbol in _SERIES:
        symbols = [symbol if reached(found[name], series) else f"{symbol}-open" for name in names]
        traces.append(
            go.Scatter(
                x=[total(found[name][series], kind) for name in names],
                y=names,
                mode="markers",
                marker={"color": series_colour(colour), "symbol": symbols, "size": 10},
                name=words,
                hovertemplate="%{y}: %{x:.3g}<extra>" + words + "</extra>",
            )
        )
    title = "unknowns" if kind == "unknowns" else "processor seconds"
    return figure(traces, power_axis(title), axis("", automargin=True), height=140 + 28 * len(names))


def _table(found: Mapping[str, Document]) -> Markup:
    rows = [
        [
            name,
            words,
            f"{mesh['unknowns']:,}",
            f"{mesh['seconds']:.1f}",
            f"{mesh['width']:.1e}",
            f"{answer['goal']:.1e}",
        ]
        for name, answer in found.items()
        for series, words, *_ in _SERIES
        for mesh in answer[series]
    ]
    header = ["set-up", "meshes", "unknowns", "seconds", "half width", "asked for"]
    return page.table(header, rows, text_columns=2)
