"""The parts of the model's error as a topic: where it comes from, by kind of set-up, and maps of it."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import plotly.graph_objects as go
from markupsafe import Markup

from analysis.report import page, plots_in_space
from analysis.report.plot import INK, Panel, axis, figure, marks, series_colour
from analysis.results.set_up import describe
from analysis.results.statistics import grouped
from analysis.results.store import write_text
from analysis.results.table import DELTA_SELF
from analysis.results.units import percent, signed_percent, too
from analysis.topics.errors import set_ups
from analysis.topics.errors.parts import EFFECTS, PARTS, QUANTITY, drawn_from_infinity, polarisation
from analysis.topics.errors.set_ups import OFFSET_MAP, SIZE_MAP, TILT_MAP, Entry, SetUp, once, statistics
from analysis.topics.topic import Topic
from geometries.common import installation
from geometries.common.measured import PICOFARAD

PERCENT = 100.0
# A part has the same colour for both quantities.
_ALL_PARTS = PARTS[DELTA_SELF]
_CLIPPED = 100.0
"""Error (per cent) at the end of a map's colour scale; larger errors have the same colour."""


@dataclass(frozen=True)
class Map:
    """What is said of a map of the error over gap and another parameter: above it, of its set-ups, along its axis, and of a place on it."""

    title: str
    set_ups: str
    across: str
    place: str


_MAPS = {
    SIZE_MAP: Map(
        "The error over gap and size ratio",
        "A square plate of another size, parallel and centred.",
        "target size over sensor size",
        "gap/size {:g} and size ratio {:g}",
    ),
    TILT_MAP: Map(
        "The error over gap and tilt",
        "A plate as large as the sensor, pivoted about an edge; the gap is that of the hinge.",
        "tilt (degrees)",
        "gap/size {:g} and tilt {:g}°",
    ),
    OFFSET_MAP: Map(
        "The error over gap and lateral offset",
        "A plate as large as the sensor, parallel and shifted along one of its sides.",
        "lateral offset over sensor size",
        "gap/size {:g} and offset {:g}",
    ),
}


def bars(caption: str, found: list[Entry], quantity: str) -> Panel:
    """Returns the mean of each part by kind of set-up, stacked; together they are the mean error, which is marked."""
    members = grouped(found, kind)

    def means(of: Callable[[Entry], float]) -> list[float]:
        return [PERCENT * float(np.mean([of(entry) for entry in own])) for own in members.values()]

    traces: list[object] = [
        go.Bar(
            x=list(members),
            y=means(lambda entry: entry.parts(quantity)[part]),
            name=part,
            marker={"color": series_colour(_ALL_PARTS.index(part))},
            hovertemplate="%{x}: %{y:+.1f} %<extra>" + part + "</extra>",
        )
        for part in PARTS[quantity]
    ]
    marker = {"color": INK, "symbol": "line-ew-open", "size": 22, "line": {"width": 3}}
    errors, hover = means(lambda entry: entry.error(quantity)), "%{x}: %{y:+.1f} %<extra>mean error</extra>"
    traces.append(marks("their sum: the model's mean error", list(members), errors, marker, hover))
    x = axis("", type="category", tickangle=-40)
    y = axis(f"part of the error in {quantity} (%)", zeroline=True, zerolinewidth=2)
    # The legend lies elsewhere, because the names of the bars need its usual place.
    legend = {"orientation": "h", "y": 1.02, "yanchor": "bottom", "x": 0, "xanchor": "left"}
    return Panel(caption, figure(traces, x, y, height=520, barmode="relative", legend=legend))


def kind(entry: Entry) -> str:
    """Returns the family of a set-up of the default study, else its group."""
    return entry.set_up.family if entry.set_up.group == set_ups.DEFAULT else entry.set_up.group


def error_map(group: str, shown: list[Entry], quantity: str) -> Panel:
    """Plots the model's error in the set-ups of a map over gap and its other axis; a click opens the set-up."""
    places = [entry.set_up.place or (0.0, 0.0) for entry in shown]
    gaps, across = (sorted({place[axis_] for place in places}) for axis_ in (0, 1))
    values = np.full((len(gaps), len(across)), np.nan)
    texts, cases = np.full(values.shape, "", dtype=object), np.full(values.shape, "", dtype=object)
    annotations = []
    for entry, (gap, other) in zip(shown, places):
        row, column = gaps.index(gap), across.index(other)
        values[row, column] = PERCENT * entry.error(quantity)
        large = {name: part for name, part in entry.parts(quantity).items() if abs(part) > 5e-4}
        told = [f"model error {values[row, column]:+.1f} %, of it"]
        told += [f"{name} {PERCENT * part:+.1f}" for name, part in large.items()]
        texts[row, column] = "<br>".join(told)
        cases[row, column] = entry.set_up.id
        # The number in its cell, light on dark.
        number = f"{round(values[row, column]) + 0.0:+.0f}"
        font = {"size": 11, "color": "white" if abs(values[row, column]) > 0.6 * _CLIPPED else INK}
        annotations.append({"x": column, "y": row, "text": number, "showarrow": False, "font": font})
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
    x, y = axis(_MAPS[group].across, type="category"), axis("gap over sensor size", type="category")
    return Panel(f"model error in {quantity} (%)", figure([trace], x, y, height=420, annotations=annotations))


ABSENT = "This version of the model has no study of its errors yet: python3 -m analysis errors does it in a minute or two."
_WHAT = (
    "A part is the decrease of the model's value when the effect is corrected, relative to the truth; its mean over all orders in which the "
    "effects can be corrected, so that the parts add up to the error exactly. Nothing is fitted. tilt: field lines are arcs, not "
    "chords. lateral path: beside the plate, field lines start and end at right angles to both plates. missing back side: the far side of the plate carries "
    "charge, too. size and reciprocity: sensor and target exchanged give another value. another quantity: mutual minus delta_self. rest: "
    "the corrected formula minus the truth. Definitions: analysis/topics/errors/ERRORS.md."
)


def sections(found: list[Entry], cases: str) -> list[Markup]:
    """Returns the parts and the maps. `cases` is the folder of the set-ups as seen from the page."""
    shown = [_parts(found, cases)]
    for group, told in _MAPS.items():
        if own := [entry for entry in found if entry.set_up.group == group]:
            figures = page.figures([error_map(group, own, quantity) for quantity in PARTS], cases)
            says = page.finding(map_finding(group, own))
            shown.append(page.section(told.title, says, figures, page.soft(told.set_ups)))
    return shown


def of_one(entry: Entry) -> list[Markup]:
    """Returns a table of the parts for each quantity."""
    return [_parts_of_one(entry, quantity) for quantity in PARTS]


def _parts_of_one(entry: Entry, quantity: str) -> Markup:
    true, effects = entry.true(quantity).value, entry.split.effects
    rows = [*entry.parts(quantity).items(), ("model − truth", entry.error(quantity))]

    def by_order(name: str) -> str:
        ends = [effects[name].least, effects[name].greatest] if name in effects else []
        return " to ".join(signed_percent(end / true) for end in ends)

    table = page.table_of(
        rows,
        ("part", lambda row: row[0]),
        ("pF", lambda row: f"{row[1] * true / PICOFARAD:+.5f}"),
        (f"of {quantity}", lambda row: signed_percent(row[1])),
        ("by the order", lambda row: by_order(row[0])),
        strong=frozenset({len(rows) - 1}),
    )
    return page.lines([page.heading(quantity), table])


def finding(found: list[Entry], quantity: str) -> str:
    """Tells the largest parts of the error and their uncertainty."""
    first, second = sorted(statistics(found, quantity), key=lambda each: -each.largest_in)[:2]
    middle = float(np.median([abs(entry.error(quantity)) for entry in found]))
    sure = float(np.median([entry.uncertainty(quantity) for entry in found]))
    return (
        f"{quantity}: over {len(found)} set-ups the model is {percent(middle)} off (median size); the greatest part is {first.name} in "
        f"{first.largest_in} of them ({percent(first.size_there)} of the truth there, median size), {second.name} in "
        f"{second.largest_in} ({percent(second.size_there)}); the parts are known to {sure:.1e} (median)."
    )


def map_finding(group: str, shown: list[Entry]) -> str:
    """Tells where on a map the error in each quantity is least and greatest, and its largest parts there."""
    phrases = []
    for quantity in PARTS:
        own = sorted(shown, key=lambda entry: entry.error(quantity))
        worst = max(own, key=lambda entry: abs(entry.error(quantity)))
        place = _MAPS[group].place.format(*(worst.set_up.place or ()))
        phrases.append(
            f"in {quantity} from {too(own[0].error(quantity))} to {too(own[-1].error(quantity))}, farthest off at {place}, mostly by "
            f"{worst.largest(quantity)} ({signed_percent(worst.parts(quantity)[worst.largest(quantity)])})"
        )
    return f"The model goes {'; '.join(phrases)}."


def _parts(found: list[Entry], cases: str) -> Markup:
    distinct = once(found)
    short = sum(not entry.reached for entry in distinct)
    return page.section(
        "The parts of the error",
        *(page.finding(finding(distinct, quantity)) for quantity in PARTS),
        page.figures([bars(f"mean error in {name} and its parts", found, name) for name in PARTS]),
        page.soft(_WHAT),
        page.paragraph("The same over all set-ups, relative to the truth:"),
        *(page.lines([page.heading(quantity), _table(distinct, quantity, cases)]) for quantity in PARTS),
        page.finding(quantity_finding(distinct)),
        page.soft(
            f"The truth is that of the boundary elements; {short} of {len(distinct)} are short of the asked 1e-4 and kept with "
            "their wider error. Between orders: the median difference between the orders in which the effects are corrected."
        ),
    )


def quantity_finding(found: list[Entry]) -> str:
    """Tells which parts make up the difference between the two quantities."""
    own = [entry.true(DELTA_SELF).value for entry in found]
    drawn = float(np.median([drawn_from_infinity(e.truth) / value for e, value in zip(found, own)]))
    raised = float(np.median([polarisation(e.truth) / value for e, value in zip(found, own)]))
    whole = float(np.median([entry.parts(DELTA_SELF)[QUANTITY] for entry in found]))
    return (
        f"mutual differs from delta_self by {signed_percent(whole)} of it (median over the set-ups): {signed_percent(drawn)} is charge that the grounded "
        f"target draws without pushing as much back to the sensor, {signed_percent(raised)} what even the floating target adds to the sensor."
    )


def _table(found: list[Entry], quantity: str, cases: str) -> Markup:
    return page.table_of(
        statistics(found, quantity),
        ("part", lambda each: each.name),
        ("median", lambda each: signed_percent(each.spread.median)),
        ("mean", lambda each: signed_percent(each.mean)),
        ("rms", lambda each: percent(each.spread.rms)),
        ("worst", lambda each: signed_percent(each.spread.worst)),
        ("greatest part in", lambda each: f"{each.largest_in} of {len(found)}"),
        ("between orders", lambda each: percent(each.between_orders) if each.name in EFFECTS else ""),
        ("worst case", lambda each: page.case_link(each.worst_case.id, each.worst_case.name, cases)),
    )


TITLE = "Where does the model's error come from?"


def make(folder: Path, found: list[Entry]) -> None:
    """Writes the page of every set-up."""
    for entry in once(found):
        text = page.document(entry.set_up.name, entry.set_up.id, _case(folder, entry), f"../../{page.SCRIPT}")
        write_text(folder / "cases" / entry.set_up.id / page.CASE_PAGE, text)


def _case(folder: Path, entry: Entry) -> Iterable[Markup]:
    made = entry.set_up
    yield page.navigation(page.link(f"../../{set_ups.STAGES.name}.html", f"‹ {TITLE}"))
    described = describe(made.scene)
    head = [] if described is None else [page.paragraph(f"{described.words}.")]
    head += [
        page.finding(
            f"{quantity}: {entry.true(quantity).in_picofarads} pF by boundary elements; the model is "
            f"{too(entry.error(quantity))}, mostly by {entry.largest(quantity)}."
        )
        for quantity in PARTS
    ]
    yield page.header(made.name, *head)
    yield page.figures([plots_in_space.in_space(made.scene)])
    yield page.section("The parts of the error", *of_one(entry))
    scene = installation.from_repository(folder / "cases" / made.id / "scene.toml")
    model, analysis = installation.model_command(), installation.command("analysis")
    yield page.section(
        "Reproduce",
        page.paragraph(
            "From the project's folder: the truth, the model, and the parts of every set-up that has none yet."
        ),
        page.command(
            f"{model} capacitance {scene} --method boundary-elements --rtol {set_ups.RTOL:g} --entries"
        ),
        page.command(f"{model} capacitance {scene}"),
        page.command(f"{analysis} errors --output {installation.from_repository(folder)}"),
        page.command(f"{installation.command('fem_reference')} {scene} --slice slice.json"),
    )


ERRORS = Topic[SetUp, Entry](
    stages=set_ups.STAGES,
    set_ups=lambda: set_ups.all_set_ups(),
    entry=set_ups.entry,
    sections=lambda found, _, cases: sections(found, cases),
    finding=lambda found: "\n".join(finding(once(found), quantity) for quantity in PARTS),
    absent=ABSENT,
    title=TITLE,
    question=TITLE,
    short="parts of the error",
    cases=make,
)
