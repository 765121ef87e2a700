"""The section on the published table: a plot whose points open the set-ups, and the page that shows these."""

from __future__ import annotations

import numpy as np
import plotly.graph_objects as go
from markupsafe import Markup

from analysis.report import page, set_ups_page
from analysis.report.plot import Panel, axis, family_marker, figure, log_axis
from analysis.report.set_ups_page import Around, Shown
from analysis.results.units import CENTIMETRE, measured
from analysis.topics.published import files, rows, stage, table
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
    families = list(dict.fromkeys(row.family for row in found))
    panels = [
        Panel("mutual, best values", _values(found, families)),
        Panel("half the width of the interval that mutual is proven to lie in", _widths(found, families)),
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


def _values(found: list[Row], families: list[str]) -> go.Figure:
    traces = [
        _points(members, [row.values[MUTUAL].best for row in members], _gaps(members), family, families)
        for family, members in _by_family(found, families)
    ]
    return figure(traces, log_axis("gap (cm)"), log_axis("mutual (pF)"))


def _widths(found: list[Row], families: list[str]) -> go.Figure:
    traces = []
    for family, members in _by_family(found, families):
        widths = [_PERCENT * float(width) for width in rows.half_widths(members, MUTUAL)]
        mutual = [row.values[MUTUAL].best for row in members]
        traces.append(_points(members, widths, mutual, family, families))
    return figure(traces, log_axis("mutual (pF)"), axis("half width (%)", rangemode="tozero"))


def _points(
    members: list[Row], upwards: list[float], across: list[float], family: str, families: list[str]
) -> go.Scatter:
    return go.Scatter(
        x=across,
        y=upwards,
        customdata=[row.case for row in members],
        mode="markers",
        marker=family_marker(family, families, size=6),
        name=family,
        hovertemplate="%{x:.4g}, %{y:.4g}<extra>" + family + "</extra>",
    )


def _by_family(found: list[Row], families: list[str]) -> list[tuple[str, list[Row]]]:
    return [(family, [row for row in found if row.family == family]) for family in families]


def _gaps(members: list[Row]) -> list[float]:
    return [row.parameters["gap"] / CENTIMETRE for row in members]


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
