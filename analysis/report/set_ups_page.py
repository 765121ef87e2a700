"""One small page for hundreds of set-ups. It shows the set-up that its address names after the #: drawing, numbers, commands."""

import re
from dataclasses import dataclass
from typing import Any

from plotly.utils import PlotlyJSONEncoder

from analysis.report import page, plots_in_space
from analysis.results.store import Document
from geometries.common import installation
from geometries.scene.scene import Scene

_TARGET = "[[object]]"
_ARRAY = re.compile(r"\[\n[^\[\]]*\]")
# The keys of a trace that depend on the set-up.
_COORDINATES = ("x", "y", "z", "i", "j", "k")


@dataclass(frozen=True, eq=False)
class Shown:
    """A set-up on the page. `name` is what its address ends in; `description` describes it, `findings` are sentences on it, `rows` are
    its numbers as text; `text` is its scene in canonical form."""

    name: str
    family: str
    description: str
    findings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    scene: Scene
    text: str


@dataclass(frozen=True)
class Around:
    """What all set-ups of a page share: its title, the file of the page that leads to it and that page's title, the head of the
    numbers, a sentence below them, and what is said after `fringe capacitance SCENE`, for each command."""

    title: str
    back: str
    back_title: str
    header: tuple[str, ...]
    explanation: str
    options: tuple[str, ...]


def document(around: Around, shown: list[Shown], inputs: str, script: str) -> str:
    """Returns the whole page. `inputs` is the hash of what it was made from, `script` the file of plotly.js as seen from it."""
    body = page.filled(
        "set_ups.html",
        script=page.static("parts.js", "set_ups.js"),
        around=around,
        count=len(shown),
        plot=page.PLOT,
        data=page.json_in_page(_data(around, shown), cls=PlotlyJSONEncoder),
    )
    return page.document(around.title, inputs, [body], script)


def _data(around: Around, shown: list[Shown]) -> Document:
    """Collects what the script needs: the look of the figure, the commands, and the set-ups."""
    drawn: dict[str, Any] = plots_in_space.in_space(shown[0].scene).figure.to_plotly_json()
    layout = {key: value for key, value in drawn["layout"].items() if key != "template"}
    looks = [{key: trace[key] for key in trace if key not in _COORDINATES} for trace in drawn["data"]]
    model = installation.model_command()
    # The text before the target is the same for most set-ups, so it is stored once.
    heads = list(dict.fromkeys(_around_target(each.text)[0] for each in shown))
    return {
        "looks": looks,
        "layout": layout,
        "commands": [
            *(f"{model} capacitance FILE {options}".rstrip() for options in around.options),
            f"{installation.command('fem_reference')} FILE --slice slice.json",
        ],
        "heads": heads,
        "setUps": [_set_up(each, heads) for each in shown],
    }


def _around_target(text: str) -> tuple[str, str]:
    """Returns a scene's text in two, before the target and the rest, with each array on a line of its own."""

    def on_one_line(array: re.Match[str]) -> str:
        return " ".join(array[0].split()).replace("[ ", "[").replace(", ]", "]")

    before, mark, rest = _ARRAY.sub(on_one_line, text).partition(_TARGET)
    return before, mark + rest


def _set_up(each: Shown, heads: list[str]) -> Document:
    bodies = plots_in_space.triangles(each.scene)
    indexed = map(plots_in_space.indexed, bodies.values())
    told = ("name", "family", "description", "findings", "rows")
    return {
        **{part: getattr(each, part) for part in told},
        "head": heads.index(_around_target(each.text)[0]),
        "scene": _around_target(each.text)[1],
        "bodies": [{"vertices": p.tolist(), "triangles": numbers.tolist()} for p, numbers in indexed],
        "aspect": [round(side, 4) for side in plots_in_space.aspect(bodies.values())],
    }
