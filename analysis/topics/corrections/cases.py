"""Every set-up as plain data: its scene, its truth and the estimate of every method."""

from __future__ import annotations

from typing import Any

import numpy as np
import plotly.graph_objects as go
from markupsafe import Markup

from analysis.report import page, set_ups_page
from analysis.report.plot import Panel, axis, family_marker, figure, log_axis
from analysis.report.set_ups_page import Around, Shown
from analysis.results.store import Document
from analysis.results.units import CENTIMETRE, percent, signed_percent, too
from analysis.topics.corrections.estimates import FORMULA, PLAIN, REDUCED, Estimates
from analysis.topics.corrections.set_ups import RTOL, SetUp, load
from geometries.common.measured import PICOFARAD, measured
from geometries.scene import reader
from geometries.scene.scene import Scene
from geometries.scene.shapes import Cuboid, PlateShape


def documents(module: Any, found: Estimates, chosen: list[SetUp]) -> list[Document]:
    """Returns every set-up with its scene, its truth and all estimates, as plain data: farads, metres."""
    truths = load()
    return [
        {
            "name": set_up.name,
            "family": set_up.family,
            "sealed": set_up.sealed,
            "distance": _distance(module, set_up.scene),
            "sensor_size": _sensor_size(set_up.scene),
            "truth": float(found.truth[index]),
            "error": truths[set_up.name].error,
            "estimates": {name: float(values[index]) for name, values in found.by_method.items()},
            "scene": set_up.text,
        }
        for index, set_up in enumerate(chosen)
    ]


def _sensor_size(scene: Scene) -> float:
    (plate,) = scene.sensors[0].plates
    return float(np.sqrt(np.linalg.norm(plate.edge_u) * np.linalg.norm(plate.edge_v)))


def _distance(module: Any, scene: Scene) -> float:
    """Returns the shortest distance between the two bodies, in metres."""
    bodies = scene.conductors()
    points = [bodies[name].reshape(-1, 3) for name in ("sensor", "target")]
    return float(module.gjk_distance(*points)[0])


SHOWN = (FORMULA, REDUCED)
"""The methods whose errors are plotted set-up by set-up."""
_PERCENT = 100.0
_WITHIN = 0.05


def section(cases: list[Document], set_ups: str) -> Markup:
    """Returns the finding and the plot; `set_ups` is the file of the page that the points open, as seen from the page."""
    return page.lines(
        [
            page.heading("Set-up by set-up"),
            page.finding(finding(cases)),
            page.figures([_panel(cases, name) for name in SHOWN], set_ups=set_ups),
            page.soft(
                "A click on a point opens its set-up. The distance is the shortest between the two bodies, the sensor's size the root of its "
                "area."
            ),
        ]
    )


def finding(cases: list[Document]) -> str:
    """Tells for how many set-ups the best closed formula is nearly right, and where it and the reduced method are worst."""
    best, reduced = SHOWN
    near = sum(abs(_error(case, best)) <= _WITHIN for case in cases)
    worst = {name: max(cases, key=lambda case: abs(_error(case, name))) for name in SHOWN}
    return (
        f"The {best} is within {percent(_WITHIN)} in {near} of {len(cases)} set-ups and worst in {_told_worst(worst[best], best)}; "
        f"{reduced} is worst in {_told_worst(worst[reduced], reduced)}."
    )


def _told_worst(case: Document, name: str) -> str:
    return f"{case['name']}, {_PERCENT * _error(case, name):+.2g} % at {_relative_distance(case):.2g} sensor sizes"


def _panel(cases: list[Document], name: str) -> Panel:
    families = list(dict.fromkeys(case["family"] for case in cases))
    traces = []
    for family in families:
        members = [case for case in cases if case["family"] == family]
        traces.append(
            go.Scatter(
                x=[_relative_distance(case) for case in members],
                y=[_PERCENT * _error(case, name) for case in members],
                customdata=[case["name"] for case in members],
                mode="markers",
                marker=family_marker(family, families, size=6),
                name=family,
                hovertemplate="%{customdata}: %{y:+.2g} %<extra></extra>",
            )
        )
    x, y = log_axis("distance over sensor size"), axis("error in mutual, %")
    return Panel(name, figure(traces, x, y))


def set_ups_document(cases: list[Document], back: str, back_title: str, inputs: str, script: str) -> str:
    """Returns the page of all set-ups; `back` is the file of the page that leads to it."""
    around = Around(
        "Set-ups of the corrections",
        back,
        back_title,
        ("method", "mutual (pF)", "off by"),
        "mutual = −M[sensor, target]. The truth's error is what boundary elements state.",
        (
            f"--method {FORMULA}",
            f"--method {REDUCED} --entries",
            f"--method boundary-elements --rtol {RTOL:g} --entries",
        ),
    )
    return set_ups_page.document(around, [_shown(case) for case in cases], inputs, script)


def _shown(case: Document) -> Shown:
    scene = reader.loads(case["scene"], case["name"])
    kept = "sealed: no constant was fitted on it" if case["sealed"] else "open to the fit of constants"
    truth, error = case["truth"] / PICOFARAD, case["error"] / PICOFARAD
    off = ", ".join(f"{name} is {too(_error(case, name))}" for name in SHOWN)
    finding_ = f"mutual: {measured(truth, error)} pF by boundary elements; {off}, the plain model {too(_error(case, PLAIN))}."
    rows = [("boundary elements", measured(truth, error), "")]
    rows += [
        (name, f"{value / PICOFARAD:.6g}", signed_percent(value / case["truth"] - 1))
        for name, value in case["estimates"].items()
    ]
    description = f"{_sizes(scene)}; {case['distance'] / CENTIMETRE:.3g} cm between them; {kept}."
    return Shown(case["name"], case["family"], description, (finding_,), tuple(rows), scene, case["scene"])


def _sizes(scene: Scene) -> str:
    """Returns both bodies' sides in words."""
    (plate,) = scene.sensors[0].plates
    shape = scene.objects[0].shape
    assert isinstance(shape, (PlateShape, Cuboid))
    sides = [float(np.linalg.norm(edge)) for edge in (plate.edge_u, plate.edge_v)]
    kind = "plate" if isinstance(shape, PlateShape) else "box"
    return f"Sensor {_lengths(sides)}, {kind} {_lengths(shape.size)}"


def _lengths(metres: Any) -> str:
    return f"{' × '.join(f'{length / CENTIMETRE:.3g}' for length in metres)} cm"


def _error(case: Document, name: str) -> float:
    return float(case["estimates"][name] / case["truth"] - 1)


def _relative_distance(case: Document) -> float:
    """Returns the distance relative to the root of the sensor's area."""
    return float(case["distance"] / case["sensor_size"])
