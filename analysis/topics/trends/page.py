"""`trends.html`: every value and every instruction count over the commits, with what has changed."""

from pathlib import Path

import plotly.graph_objects as go
from markupsafe import Markup

from analysis.pipeline import keys
from analysis.report import page
from analysis.report.plot import Panel, axis, figure, joined, series_colour
from analysis.results import study_results
from analysis.results.units import signed_percent
from analysis.topics.trends import changes
from analysis.topics.trends.changes import INSTRUCTIONS, Mark, Record
from geometries.common.measured import PICOFARAD

PAGE = "trends.html"
# Curves in a figure. More cannot be told apart; the table has all values.
_MOST = 30


def make(folder: Path) -> Path:
    """Writes the page of the trends in a folder, unless it is up to date."""
    known = folder / changes.FILE
    inputs = keys.page_inputs(keys.hash_of_files([known] if known.is_file() else [], folder))
    target = folder / PAGE
    if not page.is_current(target, inputs):
        page.provide_script(folder)
        has_report = (folder / page.REPORT).is_file()
        title = f"Trends: {study_results.title(folder) if has_report else folder.name}"
        page.write(target, _page(title, has_report, changes.load(folder), inputs))
    return target


def finding(found: list[Record], marks: list[Mark]) -> str:
    """Returns what all nights say, in a sentence or two."""
    commits = len({record.commit for record in found})
    alarms = [mark for mark in marks if mark.is_alarm]
    said = f"{len({record.series for record in found})} values over {commits} commits: "
    if not alarms:
        return f"{said}none has changed by more than its errors allow."
    last = alarms[-1].after
    return (
        f"{said}{len({mark.after.series for mark in alarms})} of them have changed by more than their errors allow, the last time on "
        f"{_day(last)} at commit {_short(last)}."
    )


def _page(title: str, has_report: bool, found: list[Record], inputs: str) -> str:
    marks = changes.marks(found)
    told, held = ([mark for mark in marks if mark.held == back] for back in (False, True))
    parts = [
        page.header(
            title,
            page.finding(finding(found, marks)),
            page.paragraph(
                "A cross marks a change by more than both errors, or a mean of four nights that has drifted by as much; a circle one that "
                "is held back, because most values of the method moved when the machine was exchanged. Instructions may grow by 1 %. "
                "Run times by the clock are kept, but never looked at."
            ),
            page.paragraph(page.link(page.REPORT, "What the last night found") if has_report else ""),
        ),
        page.figures(_panels(found, marks)),
        page.section("Changes", _changes(told) if told else page.paragraph("There is none.")),
    ]
    if held:
        parts.append(page.section("Held back", page.folded(f"Show {len(held)} changes", _changes(held))))
    parts.append(page.section("Every value", page.folded("Show the values", _values(found))))
    return page.document(title, inputs, parts, page.SCRIPT)


def _panels(found: list[Record], marks: list[Mark]) -> list[Panel]:
    """Returns a figure for each method, and one for the counts."""
    symbols = {mark.after: "circle-open" if mark.held else "x" for mark in marks}
    commits = axis("commit", type="category", categoryorder="array", categoryarray=[*map(_short, found)])
    panels = []
    for kind in dict.fromkeys(record.kind for record in found):
        own = [each for (of, _), each in changes.by_series(found).items() if of == kind]
        own.sort(key=lambda each: -max(abs(_since_first(each[0], record)) for record in each))
        curves = [_curve(each, series_colour(index), symbols) for index, each in enumerate(own[:_MOST])]
        which = f"{len(own)} values"
        if len(own) > _MOST:
            which = f"the {_MOST} of {which} that changed most"
        height = axis("change (%)" if kind == INSTRUCTIONS else "change over errors")
        drawn = figure(curves, commits, height, showlegend=False)
        panels.append(Panel(f"{kind}, since the first night: {which}", drawn))
    return panels


def _curve(own: list[Record], colour: str, symbols: dict[Record, str]) -> go.Scatter:
    shown = [symbols.get(each, "circle") for each in own]
    sizes = [11 if each in symbols else 6 for each in own]
    values = [_since_first(own[0], each) for each in own]
    marker = {"color": colour, "symbol": shown, "size": sizes}
    return joined(own[0].name, [*map(_short, own)], values, colour, "%{x}: %{y:.3g}", marker=marker)


def _since_first(first: Record, record: Record) -> float:
    """Returns the change of a value since its first night, relative to both errors; of a count in per cent."""
    change, error = record.value - first.value, first.error + record.error
    if record.kind == INSTRUCTIONS:
        return 100 * change / first.value
    return change / error if change and error else 0.0


def _changes(marks: list[Mark]) -> Markup:
    return page.table_of(
        reversed(marks),
        ("night (UTC)", lambda mark: _day(mark.after)),
        ("value", lambda mark: _named(mark.after)),
        ("method", lambda mark: mark.after.kind),
        ("what", lambda mark: mark.what),
        ("commits", lambda mark: f"{_short(mark.before)} … {_short(mark.after)}"),
        ("before", lambda mark: _shown(mark.before)),
        ("after", lambda mark: _shown(mark.after)),
        ("change", lambda mark: signed_percent(mark.relative, 2)),
        ("over errors", lambda mark: f"{mark.over:.3g}"),
        text_columns=5,
    )


def _values(found: list[Record]) -> Markup:
    return page.table_of(
        changes.by_series(found).values(),
        ("value", lambda own: _named(own[-1])),
        ("method", lambda own: own[-1].kind),
        ("records", lambda own: str(len(own))),
        ("first", lambda own: _shown(own[0])),
        ("last", lambda own: _shown(own[-1])),
        ("last commit", lambda own: _short(own[-1])),
        text_columns=2,
    )


def _named(record: Record) -> str | Markup:
    return page.case_link(record.case, record.name, "cases") if record.case else record.name


def _shown(record: Record) -> str:
    if record.kind == INSTRUCTIONS:
        return f"{record.value:,.0f}"
    return f"{record.value / PICOFARAD:.6g} pF"


def _short(record: Record) -> str:
    return record.commit[:9] + ("-dirty" if record.commit.endswith("-dirty") else "")


def _day(record: Record) -> str:
    return record.time[:16].replace("T", " ")
