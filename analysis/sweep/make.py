"""`python3 -m analysis sweep SCENE`: runs `fringe sweep` and makes the page of its table: plots of the changes and the readings over the frames, where
thresholds are crossed, and every number."""

import math
import shlex
import subprocess
from pathlib import Path

import plotly.graph_objects as go
from markupsafe import Markup

from analysis.pipeline import keys
from analysis.report import page
from analysis.report.plot import INK, Panel, axis, figure, guide, joined, marks, power_axis, series_colour
from analysis.results.answers import Estimate
from analysis.show import find_scene, motion_beside
from analysis.sweep import series
from analysis.sweep.series import Crossing, Series, Sweep, crossings, place_words
from geometries.common import installation
from geometries.common.children import ending_with_this
from geometries.common.errors import InputError
from geometries.common.measured import measured
from geometries.scene import motion, reader
from geometries.scene.motion import Frame

METHODS = "exact,formula,auto,boundary-elements"
"""The model, the formula, and what states an error."""
RTOL = 1e-2
_STATING = ("auto", "boundary-elements", "reduced")
_ANSWERED, _NOT_REACHED = 0, 3


def make(
    name: str,
    motion_file: Path | None = None,
    target: Path | None = None,
    methods: str = METHODS,
    rtol: float | None = None,
) -> tuple[page.Made | None, int]:
    """Runs the sweep of a scene, a file or a name in geometries/scenes, and writes its page, with the table beside it under the same
    name, of a scene outside of the repository in the current folder. Frames that the table holds already are not computed again.

    `methods` are separated by commas; of those that state errors the relative error `rtol` is asked, RTOL if it is None. Returns
    the page, None of a sweep that failed, and the exit status. InputError for files that cannot be used."""
    path = find_scene(name)
    scene = reader.load(path)
    moved = motion_file or motion_beside(path)
    if moved is None:
        raise InputError(str(path), "", "has no motion beside it: name one by --motion")
    frames = motion.load(moved, scene)
    place = target or installation.results_folder(path) / "sweep" / f"{path.stem}.html"
    table = place.with_suffix(".csv")
    arguments = ["sweep", str(path), "--motion", str(moved), "--method", methods]
    if rtol is not None or any(method.startswith(_STATING) for method in methods.split(",")):
        arguments += ["--rtol", f"{RTOL if rtol is None else rtol:g}"]
    command = [*arguments, "--output", str(table)]
    # Its progress and its messages go to the terminal.
    program = ending_with_this([installation.model_program(), *command])
    status = subprocess.run(program, stdout=subprocess.DEVNULL, check=False).returncode
    if status not in (_ANSWERED, _NOT_REACHED):
        return None, status
    found = series.read(table)
    inputs = keys.page_inputs(table.read_text(encoding="utf-8"))
    title = f"{path.stem.replace('_', ' ')}: readings over {len(frames)} frames"
    shown = shlex.join([installation.model_command(), *command])
    page.provide_script(place.parent)
    page.write(place, document(title, inputs, found, frames, table.name, shown))
    return page.Made(place, "\n".join(findings(found, frames))), status


_FEMTO, _PICO, _MILLI = 1e-15, 1e-12, 1e-3
_TRUTH = "best truth at hand"
_ERRORS = (
    "The band is the error that the best answer states, an estimate: of all methods that state an error, the answer with the least is "
    "taken in every frame. Methods without a band state none. Changes are shown by their size; between frames nothing was computed."
)
_CROSSING = (
    "Where a threshold is crossed is interpolated between two frames, by the logarithms of the sizes; the interval is where the ends of "
    "the error band cross it."
)


def document(
    title: str, inputs: str, sweep: Sweep, motion: tuple[Frame, ...], table: str, command: str
) -> str:
    """Returns the whole page; plotly.js is to be beside it (`page.provide_script`). `table` is the CSV file as seen from the page, `command` makes it anew."""
    numbers = Markup("{}: every frame, reading and method, in full.").format(page.link(table, table))
    more = page.paragraph(numbers), page.command(command), page.soft(_ERRORS), page.soft(_CROSSING)
    body = [
        page.header(title, *map(page.finding, findings(sweep, motion))),
        *(_section(series, sweep.frames) for series in sweep.series),
        page.section("Numbers and command", *more),
    ]
    return page.document(title, inputs, body, page.SCRIPT)


def findings(sweep: Sweep, motion: tuple[Frame, ...]) -> list[str]:
    """Returns a sentence for each reading with a threshold, by the best truth at hand."""
    found = []
    for series in sweep.series:
        if series.threshold is None:
            continue
        places = _crossings(series)
        subject = f"{series.reading}, threshold {series.threshold / _FEMTO:.4g} fF: "
        told = "; ".join(_crossing(each, sweep, motion) for each in places)
        noticed = {said.noticed for said in series.truth if said.is_truth}
        found.append(f"{subject}{told or _never_crossed(noticed)}.")
    return found


def _crossings(series: Series) -> list[Crossing]:
    """Returns where the best truth at hand crosses the threshold."""
    if series.threshold is None:
        return []
    known = [(said.change.value, said.change.error) if said.change else (None, 0.0) for said in series.truth]
    changes, errors = zip(*known)
    return crossings(list(changes), list(errors), series.threshold)


def _never_crossed(noticed: set[str]) -> str:
    if not noticed:
        return "no method states an error, so it is not known where it is noticed"
    if noticed == {"yes"}:
        return "noticed in every frame"
    always = noticed == {"no"}
    return "not noticed in any frame" if always else "not crossed, but in some frames the error decides"


def _crossing(crossing: Crossing, sweep: Sweep, motion: tuple[Frame, ...]) -> str:
    before = "frame 1" if crossing.first is None else f"frame {crossing.first:.2f}"
    after = f"frame {len(sweep.frames)}" if crossing.last is None else f"frame {crossing.last:.2f}"
    beyond = " and beyond" if crossing.first is None or crossing.last is None else ""
    number = math.floor(crossing.at)
    between = f"between {sweep.frames[number - 1]} and {sweep.frames[number]}"
    place = place_words(motion, crossing.at)
    return (
        f"{'noticed' if crossing.rises else 'no longer noticed'} from frame {crossing.at:.2f} on, {between}"
        f"{f', {place}' if place else ''} (the error allows {before} to {after}{beyond})"
    )


def _section(series: Series, frames: tuple[str, ...]) -> Markup:
    panels = [Panel("size of the change (fF), all methods", _changes(series, frames))]
    if any(said.value is not None for said in series.truth):
        caption = "the reading and its background without the targets (pF)"
        traces = [
            _line([said.value for said in series.truth], "reading", 0, "solid"),
            _line([said.background for said in series.truth], "background", 1, "dot"),
        ]
        panels.append(Panel(caption, figure(traces, _frames_axis(frames), axis("pF"), height=360)))
    known = [said.delta_voltage for said in series.truth]
    if any(each is not None for each in known):
        values = [None if each is None else each / _MILLI for each in known]
        taken = joined(_TRUTH, list(range(1, len(frames) + 1)), values, series_colour(0), "%{y:.4g} mV")
        drawn = figure([taken], _frames_axis(frames), axis("mV"), height=320)
        panels.append(Panel("what the targets take from the output (mV)", drawn))
    numbers = page.folded("Show the numbers", _numbers(series, frames))
    return page.section(f"Reading {series.reading}", page.figures(panels), numbers)


def _frames_axis(frames: tuple[str, ...]) -> dict[str, object]:
    return axis("frame", tickvals=list(range(1, len(frames) + 1)), ticktext=list(frames))


def _changes(series: Series, frames: tuple[str, ...]) -> go.Figure:
    traces = _band([said.change for said in series.truth])
    across, hover = list(range(1, len(frames) + 1)), "%{y:.5g} fF by %{text}"
    for number, (method, said) in enumerate(series.methods.items()):
        sizes = [abs(each.change.value) / _FEMTO if each.change is not None else 0.0 for each in said]
        # A logarithmic axis has no zero and no infinity.
        values = [size if 0 < size < math.inf else None for size in sizes]
        if any(values):
            answered_by = [each.answered_by or "no answer" for each in said]
            traces.append(joined(method, across, values, series_colour(number), hover, text=answered_by))
    if series.threshold is not None:
        height = series.threshold / _FEMTO
        traces.append(guide(f"threshold {height:.4g} fF", [1, len(frames)], [height] * 2, dash="dash"))
        traces += _marks(_crossings(series), height, len(frames))
    return figure(traces, _frames_axis(frames), power_axis("size of the change (fF)"), height=460)


def _marks(places: list[Crossing], height: float, count: int) -> list[go.Scatter]:
    """Returns a mark where the threshold is crossed, with a bar along the frames that the error allows."""
    if not places:
        return []
    bars = {
        "type": "data",
        "array": [(each.last or float(count)) - each.at for each in places],
        "arrayminus": [each.at - (each.first or 1.0) for each in places],
    }
    marker = {"color": INK, "symbol": "diamond", "size": 10}
    hover = "crossed at frame %{x:.2f}<extra></extra>"
    at = [each.at for each in places]
    return [marks("crossed here", at, [height] * len(at), marker, hover, error_x=bars)]


def _band(changes: list[Estimate | None]) -> list[go.Scatter]:
    """Returns the band from the size of each change less its error to the size and its error, over the frames where they are known."""
    numbered = enumerate(changes, start=1)
    known = [(number, each) for number, each in numbered if each is not None and math.isfinite(each.error)]
    if not known:
        return []
    # On a logarithmic axis the lower end stays above zero.
    low = [max(abs(each.value) - each.error, 1e-3 * abs(each.value)) / _FEMTO for _, each in known]
    high = [(abs(each.value) + each.error) / _FEMTO for _, each in known]
    numbers = [number for number, _ in known]
    return [
        go.Scatter(
            x=[*numbers, *reversed(numbers)],
            y=[*high, *reversed(low)],
            fill="toself",
            fillcolor="rgba(128, 136, 146, 0.35)",
            line={"width": 0},
            mode="lines",
            name=f"error of the {_TRUTH}",
            hoverinfo="skip",
        )
    ]


def _line(values: list[Estimate | None], name: str, number: int, dash: str) -> go.Scatter:
    bars = [0 if each is None or math.isnan(each.error) else each.error / _PICO for each in values]
    shown = [None if each is None else each.value / _PICO for each in values]
    across = list(range(1, len(values) + 1))
    return joined(f"{name}, {_TRUTH}", across, shown, series_colour(number), "%{y:.5g} pF", bars, dash=dash)


def _numbers(series: Series, frames: tuple[str, ...]) -> Markup:
    header = ["frame", "best change (fF)", "by", "noticed", *(f"{method} (fF)" for method in series.methods)]
    rows = []
    for number, name in enumerate(frames):
        best, others = series.truth[number], [said[number] for said in series.methods.values()]
        told = [_text(best.change), best.answered_by, best.noticed]
        rows.append([f"{number + 1} {name}", *told, *(_text(said.change) for said in others)])
    return page.table(header, rows)


def _text(change: Estimate | None) -> str:
    if change is None:
        return ""
    value, error = change.value / _FEMTO, change.error / _FEMTO
    return f"{value:.5g}" if math.isnan(error) else measured(value, error)
