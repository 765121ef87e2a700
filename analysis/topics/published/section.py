"""The section on the published table: a plot whose points open the set-ups, and the page that shows these."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import plotly.graph_objects as go
from markupsafe import Markup

from analysis.report import page, set_ups_page
from analysis.report.plot import Panel, axis, by_family, figure, log_axis
from analysis.report.set_ups_page import Around, Shown
from analysis.results.units import CENTIMETRE, measured
from analysis.topics.published import files, stage, table
from analysis.topics.published.files import Check
from analysis.topics.published.page import COMMAND, check_finding, headline
from analysis.topics.published.rows import MUTUAL, QUANTITIES, Row
from geometries.common import installation
from geometries.studies.study import Case

TITLE = "A reference table of capacitances around a plate"
Published = tuple[list[Row], list[Check]]
"""The rows of the table, and what the field solver finds of some."""
_PERCENT = 100.0


def section(published: Published, set_ups: str) -> Markup:
    """Tells what the table holds and how sure it is; `set_ups` is the file of the page of its set-ups, as seen from the page."""
    found, checks = published
    gaps, widths = log_axis("gap (cm)"), axis("half width (%)", rangemode="tozero")
    values = _points(
        found, lambda row: row.parameters["gap"] / CENTIMETRE, lambda row: row.values[MUTUAL].best
    )
    halves = _points(
        found, lambda row: row.values[MUTUAL].best, lambda row: _PERCENT * row.values[MUTUAL].half_width
    )
    panels = [
        Panel("mutual, best values", figure(values, gaps, log_axis("mutual (pF)"))),
        Panel(
            "half the width of the interval that mutual is proven to lie in",
            figure(halves, log_axis("mutual (pF)"), widths),
        ),
    ]
    place = table.PLACE.relative_to(table.PLACE.parent.parent)
    return page.section(
        TITLE,
        page.finding(headline(found, checks)),
        page.figures(panels, set_ups=set_ups),
        page.soft(
            f"A click on a point opens its set-up. {check_finding(checks).replace('`', '')} The table is {place / files.TABLE}, explained in "
            f"{files.PAGE} beside it; to make it anew: {COMMAND}."
        ),
    )


def set_ups_document(published: Published, back: str, back_title: str, inputs: str, script: str) -> str:
    """Returns the page of the table's set-ups; `back` is the file of the page that leads to it, `inputs` the hash of what it is made from."""
    found, _ = published
    texts = {case.id: case for case in stage.cases()}
    around = Around(
        "Set-ups of the published table",
        back,
        back_title,
        ("quantity (pF)", "best value", "proven: low", "high"),
        "mutual = −M[sensor, target], self = M[s,s] or M[t,t], delta_self = M[s,s] − M0[s,s], M0 without the target. To make the whole "
        f"table anew: {installation.command('analysis')} table",
        (f"--method boundary-elements --rtol {min(stage.RTOLS):g} --entries",),
    )
    return set_ups_page.document(around, [_shown(row, texts[row.case]) for row in found], inputs, script)


def _points(found: list[Row], x: Callable[[Row], float], y: Callable[[Row], float]) -> list[go.Scatter]:
    hover = "%{x:.4g}, %{y:.4g}"
    return by_family(found, lambda row: row.family, hover, size=6, x=x, y=y, customdata=lambda row: row.case)


def _shown(row: Row, case: Case) -> Shown:
    mutual = row.values[MUTUAL]
    finding = f"mutual: {measured(mutual.best, mutual.error)} pF, proven to lie in [{mutual.low:.7g}, {mutual.high:.7g}]."
    numbers = []
    for quantity in QUANTITIES:
        value = row.values[quantity]
        numbers.append(
            (
                quantity,
                measured(value.best, value.error),
                f"{value.low:.7g}",
                f"{value.high:.7g}",
            )
        )
    return Shown(
        row.case, row.family, _description(row, case), (finding,), tuple(numbers), case.scene, case.text
    )


def _description(row: Row, case: Case) -> str:
    """Describes a row's parameters in words."""
    (plate,) = case.scene.sensors[0].plates
    sides = (f"{np.linalg.norm(edge) / CENTIMETRE:g}" for edge in (plate.edge_u, plate.edge_v))
    phrases = [f"Sensor {' × '.join(sides)} cm"]
    for name, value in row.parameters.items():
        label = name.replace("_", " ")
        if name.endswith("_degrees"):
            phrases.append(f"{label.removesuffix(' degrees')} {value:g}°")
        else:
            phrases.append(f"{label} {value / CENTIMETRE:g} cm")
    return ", ".join(phrases) + "."
