"""HTML pages that work offline: their frame and their parts."""

import itertools
import json
import re
import shutil
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup
from plotly.offline import get_plotlyjs
from plotly.utils import PlotlyJSONEncoder

from analysis.report.plot import Panel, Plot
from analysis.results.store import Document, csv_text, write_text

Trace = dict[str, Any]
_COLUMNS = ("value", "error", "error below", "note", "set-up")
_IN_SPACE = ("mesh3d", "scatter3d", "cone", "surface")
_BREAK = re.compile(r"<br>")


def to_csv(traces: list[Trace], layout: dict[str, Any]) -> str:
    """Returns a line for each point of a figure: its series, where it is along both axes, which give the columns their names, and of its value, its
    error, its note and its set-up those that any point has."""
    rows = [row for trace in traces for row in _rows(trace)]
    used = [column for column in range(3, 3 + len(_COLUMNS)) if any(row[column] is not None for row in rows)]
    titles = [layout.get(axis, {}).get("title", {}).get("text") or axis[0] for axis in ("xaxis", "yaxis")]
    header = ["series", *titles, *(_COLUMNS[column - 3] for column in used)]
    return csv_text(header, ([*row[:3], *(row[column] for column in used)] for row in rows))


def _rows(trace: Trace) -> Iterator[list[Any]]:
    name, across, upwards = trace.get("name", ""), trace.get("x") or [], trace.get("y") or []
    if "z" in trace:
        told = (trace.get(key) or [[]] * len(upwards) for key in ("text", "customdata"))
        for y, values, texts, cases in zip(upwards, trace["z"], *told):
            for column, (x, value) in enumerate(zip(across, values)):
                yield [name, x, y, value, None, None, _note(texts, column), _at(cases, column)]
        return
    bars = trace.get("error_y") or trace.get("error_x") or {}
    for index, (x, y) in enumerate(zip(across, upwards)):
        errors = (_at(bars.get(key), index) for key in ("array", "arrayminus"))
        note = _note(trace.get("text") or trace.get("hovertext"), index)
        yield [name, x, y, None, *errors, note, _at(trace.get("customdata"), index)]


def _at(values: Any, index: int) -> Any:
    return values[index] if isinstance(values, list) and index < len(values) else None


def _note(texts: Any, index: int) -> str | None:
    text = _at(texts, index)
    return _BREAK.sub("; ", text) if text else None


REPORT = "report.html"
SCRIPT = "report/plotly.js"
"""plotly.js, megabytes, once for all pages of a folder of results."""
CASES = "../cases"
"""The cases' folder as seen from a page in the folder of the pages."""
CASE_PAGE = "case.html"
DATA = "data"
"""The folder of the figures' data, beside the page."""
PLOT = "plotly-graph-div"
"""The HTML class of the element that a figure is drawn in."""

_Item = TypeVar("_Item")
_HEIGHT = 400
_DRAWN = re.compile(r"Plotly\.newPlot\(document\.currentScript\.previousElementSibling, (.*?)\);</script>")
_WITH_DATA = re.compile(
    rf'href="{DATA}/(?P<words>\w+)\.csv"(?P<rest>.*?{_DRAWN.pattern.replace("(.*?)", "(?P<drawn>.*?)")})'
)
_WORDS = 6
"""Words of a figure's caption in the name of the file of its data."""
# The mark of the inputs is within so many characters of a page's beginning; its scripts may take megabytes.
_MARK_WITHIN = 1000

_FOLDER = Path(__file__).parent
_TEMPLATES = Environment(
    loader=FileSystemLoader(_FOLDER / "templates"),
    autoescape=True,
    trim_blocks=True,
    lstrip_blocks=True,
    undefined=StrictUndefined,
)
_MINUS = re.compile(r"(?<![\w.)\]])-(?=[\d.∞])")


# Sets a minus sign before numbers in plain text; the hyphen of a keyboard is shorter than the plus it stands below. HTML, as
# of commands that readers copy, is left as it is.
_TEMPLATES.filters["typographic"] = lambda text: text if isinstance(text, Markup) else _MINUS.sub("−", text)
_PARTS: Any = _TEMPLATES.get_template("parts.html").module


@dataclass(frozen=True)
class Made:
    """A page that was written: its path, and its finding."""

    path: Path
    headline: str


def filled(template: str, **values: object) -> Markup:
    """Fills a template of the folder `templates`; plain text is escaped."""
    return Markup(_TEMPLATES.get_template(template).render(values))


def static(*files: str) -> Markup:
    """Returns the text of a style or of scripts of the folder `static`."""
    return Markup("\n".join((_FOLDER / "static" / file).read_text(encoding="utf-8") for file in files))


def json_in_page(data: object, **more: Any) -> Markup:
    """Returns data as JSON that may stand within a script element; `more` is for json.dumps."""
    # The text of a script must not contain the tag that ends its HTML element.
    return Markup(json.dumps(data, separators=(",", ":"), **more).replace("</", "<\\/"))


def script(text: str) -> Markup:
    """Returns a script as it may stand in a page."""
    return Markup(text.replace("</script", "<\\/script"))


def document(title: str, inputs: str, body: Iterable[Markup], script: str | None = None) -> str:
    """Returns the whole page. `inputs`, the hash of what it was made from, is kept in its head. plotly.js is the file `script`, named as
    seen from the page; it is put into the page where that is None, and left out where it is empty."""
    return filled(
        "page.html",
        title=title,
        mark=inputs_mark(inputs),
        style=static("page.css"),
        script=static("page.js"),
        plotly=Markup(get_plotlyjs()) if script is None else None,
        plotly_file=script or None,
        body=list(body),
    )


def write(target: Path, text: str) -> None:
    """Writes a page, and the data of its figures into a folder of their own beside it."""
    folder = f"{DATA}/{target.stem}"
    shutil.rmtree(target.parent / folder, ignore_errors=True)
    numbers = itertools.count(1)

    def with_file(figure: re.Match[str]) -> str:
        file = f"{folder}/{next(numbers)}_{figure['words']}.csv"
        traces, layout, _ = json.loads(f"[{figure['drawn']}]")
        write_text(target.parent / file, to_csv(traces, layout))
        return f'href="{file}"{figure["rest"]}'

    write_text(target, _WITH_DATA.sub(with_file, text))


def provide_script(folder: Path) -> None:
    """Puts plotly.js into a folder of results, unless it is there."""
    text, target = get_plotlyjs(), folder / SCRIPT
    if not target.is_file() or target.stat().st_size != len(text.encode()):
        write_text(target, text)


def inputs_mark(inputs: str) -> Markup:
    """Returns the line in a page's head by which a later run sees that the page is up to date."""
    return Markup('<meta name="made-from" content="{}">').format(inputs)


def is_current(page: Path, inputs: str) -> bool:
    """Tells whether a page was made from just these inputs."""
    if not page.is_file():
        return False
    with page.open(encoding="utf-8") as file:
        return inputs_mark(inputs) in file.read(_MARK_WITHIN)


def _text(macro: str, *more: str) -> Callable[[str], Markup]:
    """Returns what makes a part of a text; `more` is told the macro besides."""
    made = getattr(_PARTS, macro)
    return lambda text: Markup(made(text, *more))


paragraph, code, strong = _text("paragraph", ""), _text("code"), _text("strong")
finding, soft = _text("paragraph", "finding"), _text("paragraph", "soft")
"""Paragraphs that say what was found out, and that explain, in a lighter colour."""
heading, command = _text("heading"), _text("command")
"""The title of a part of a section, and a command on a line of its own, which may be long."""


def section(title: str, *parts: Markup) -> Markup:
    return Markup(_PARTS.section(title, parts))


def header(title: str | Markup, *parts: Markup) -> Markup:
    """Returns the head of a page: its title and what it says first."""
    return Markup(_PARTS.header(title, parts))


def navigation(*links: Markup) -> Markup:
    """Returns the way to other pages, above the title."""
    return Markup(_PARTS.navigation(links))


def lines(parts: Iterable[Markup]) -> Markup:
    """Puts parts below each other."""
    return Markup("\n").join(parts)


def beside(left: Iterable[Markup], right: Iterable[Markup]) -> Markup:
    """Puts parts beside others where the screen is wide enough."""
    return Markup(_PARTS.beside(list(left), list(right)))


def plot_section(plot: Plot, cases: str = CASES) -> Markup:
    """Returns a plot with its finding above and its explanation below. `cases` is the folder of the cases as seen from the page."""
    parts = [finding(plot.finding), figures(plot.panels, cases)]
    if plot.explanation:
        parts.append(soft(plot.explanation))
    return section(plot.title, *parts)


def figures(panels: list[Panel], cases: str = CASES, set_ups: str = "", with_data: bool = True) -> Markup:
    """Panels side by side. `cases` is the folder of the cases that their points open, as seen from the page; where they open set-ups
    that are all on one page (analysis.report.set_ups_page), `set_ups` is its file. Each has a link to its data, which `write` writes, if wanted.
    """
    drawn = [_figure(panel, with_data) | {"caption": panel.caption, "kind": PLOT} for panel in panels]
    return Markup(_PARTS.figures(drawn, cases, set_ups))


def two_lines(first: str, second: str, small: bool = False) -> Markup:
    """Returns two lines in a cell of a table."""
    return Markup(_PARTS.two_lines(first, second, small))


def yes_or_no(held: bool) -> str:
    """Returns what a table says of something that should hold."""
    return "yes" if held else strong("no")


def link(target: str, text: str | Markup, current: bool = False) -> Markup:
    """Returns a link to a file, relative to the page; `current` if it is the page itself."""
    return Markup(_PARTS.link(target, text, current))


def case_link(case: str, name: str, cases: str = CASES) -> Markup:
    """Returns a link to the page of a case or set-up, given by its id; the link's text is its name in words."""
    return link(f"{cases}/{case}/{CASE_PAGE}", name)


def folded(summary: str, content: Markup) -> Markup:
    """Hides content that few readers need until a click opens it."""
    return Markup(_PARTS.folded(summary, content))


def table(
    header: list[str], rows: list[list[str]], text_columns: int = 1, strong: frozenset[int] = frozenset()
) -> Markup:
    """Returns a table; the first `text_columns` are set left, the rest, numbers, right. The rows numbered in `strong` are bold."""
    return Markup(_PARTS.table(header, rows, text_columns, strong))


def table_of(
    items: Iterable[_Item],
    *columns: tuple[str, Callable[[_Item], str]],
    text_columns: int = 1,
    strong: frozenset[int] = frozenset(),
) -> Markup:
    """Returns a table with a row for each item; a column is its title and what it shows of an item."""
    rows = [[shown(each) for _, shown in columns] for each in items]
    return table([title for title, _ in columns], rows, text_columns, strong)


def figures_of(text: Markup) -> list[tuple[list[dict[str, Any]], dict[str, Any]]]:
    """Returns the data and the layout of every figure in a page's body."""
    found = [json.loads(f"[{drawn}]") for drawn in _DRAWN.findall(text)]
    return [(data, layout) for data, layout, _ in found]


def _figure(panel: Panel, with_data: bool) -> dict[str, object]:
    """Returns the height of a figure, the arguments that plotly draws it from, and the file of its data, empty without one. Everything is styled by
    `plot.figure`: plotly's template, longer than most figures, is left out."""
    content = panel.figure.to_plotly_json()
    layout = {key: value for key, value in content["layout"].items() if key != "template"}
    config = {"responsive": True, "displaylogo": False, "displayModeBar": False}
    parts = (json_in_page(part, cls=PlotlyJSONEncoder) for part in (content["data"], layout, config))
    file = ""
    # Bodies in space have no numbers along two axes.
    if with_data and not any(trace.get("type") in _IN_SPACE for trace in content["data"]):
        words = "_".join(re.findall(r"[a-z0-9]+", panel.caption.lower())[:_WORDS])
        file = f"{DATA}/{words or 'figure'}.csv"
    return {"height": layout.get("height", _HEIGHT), "data": Markup(", ").join(parts), "file": file}


_ABSENT = (
    "These results have no measurement by this version of the model on this machine: ./run does it with the default study, and "
    "python3 -m analysis run STUDY --measure-model with any."
)


def measured_section(
    title: str, documents: Iterable[Document | None], parts: Callable[..., Iterable[Markup]], before: str = ""
) -> Markup:
    """Returns the section on stored answers: its parts, which are made of these documents, then where the answers were measured, and how to
    measure them again; or that there are none."""
    asked = tuple(documents)
    known = [document for document in asked if document is not None]
    if not known:
        return section(title, paragraph(_ABSENT))
    machine = f"{known[0]['processor']} with {known[0]['instruction_sets']}"
    again = f"Again, from the project's folder: {'; '.join(document['command'] for document in known)}"
    return section(title, *parts(*asked), soft(f"{before}{machine}. {again}"))
