"""HTML pages that work offline: their frame and their parts."""

from __future__ import annotations

import json
from collections.abc import Iterable
from html import escape
from pathlib import Path
from typing import Any

from plotly.offline import get_plotlyjs
from plotly.utils import PlotlyJSONEncoder

from analysis.report.plot import Panel, Plot
from analysis.results.store import write_text

REPORT = "report.html"
SCRIPT = "report/plotly.js"
"""Of all pages of a folder of results: megabytes, so it is there once."""
CASES = "../cases"
"""The cases' folder as seen from a page in the folder of the pages."""
CASE_PAGE = "case.html"
PLOT = "plotly-graph-div"
"""The class of a figure's place."""

_STYLE = """
:root { --ink: #24292f; --soft: #57606a; --line: #d8dee4; --tint: #f6f8fa; --accent: #0b5394; }
* { box-sizing: border-box; }
body { margin: 0; color: var(--ink); background: white; line-height: 1.55;
       font: 16px/1.55 system-ui, -apple-system, "Segoe UI", "DejaVu Sans", sans-serif; }
main { max-width: 76rem; margin: 0 auto; padding: 2.5rem 1.25rem 4rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .4rem; }
h2 { font-size: 1.3rem; margin: 3rem 0 .4rem; padding-top: 1.2rem; border-top: 1px solid var(--line); }
header + section h2 { border-top: 0; padding-top: 0; margin-top: 1.4rem; }
h3 { font-size: 1rem; margin: 1.6rem 0 .3rem; }
p { max-width: 46rem; margin: .5rem 0; }
a { color: var(--accent); }
.soft { color: var(--soft); font-size: .92rem; }
.finding { border-left: 3px solid var(--accent); padding-left: .8rem; }
.panels { display: grid; grid-template-columns: repeat(2, minmax(0, 1fr)); gap: 1rem 1.5rem; }
.panel { min-width: 0; margin: .6rem 0 0; }
.panels.single { grid-template-columns: minmax(0, 56rem); }
.panel figcaption { color: var(--soft); font-size: .92rem; }
.scroll { overflow-x: auto; margin: .8rem 0; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .9rem; }
th, td { padding: .3rem .7rem .3rem 0; text-align: right; border-bottom: 1px solid var(--line); white-space: nowrap; }
th { color: var(--soft); font-weight: 600; vertical-align: bottom; }
th.text, td.text { text-align: left; }
tr.strong td { font-weight: 600; }
code { font: .86em ui-monospace, "DejaVu Sans Mono", monospace; background: var(--tint); padding: .1em .3em; }
td code { background: none; padding: 0; }
code.command { display: block; padding: .5em .7em; margin: .5rem 0; overflow-wrap: anywhere; }
html { overflow-y: scroll; }
nav { font-size: .92rem; margin: 0 0 1.4rem; display: flex; flex-wrap: wrap; gap: .2rem 1rem; }
nav a[aria-current] { color: var(--ink); font-weight: 600; text-decoration: none; }
.cards { display: grid; grid-template-columns: repeat(2, minmax(0, 1fr)); gap: 1rem 1.5rem; margin: 1.4rem 0; padding: 0; }
.cards li { list-style: none; border: 1px solid var(--line); border-radius: 6px; padding: .8rem 1rem; }
.cards a { font-weight: 600; } .cards p { margin: .3rem 0 0; font-size: .92rem; color: var(--soft); }
details { margin: .8rem 0; } summary { cursor: pointer; color: var(--accent); }
@media (max-width: 52rem) {
  .panels, .panels.single, .cards { grid-template-columns: minmax(0, 1fr); }
  main { padding: 1.2rem .9rem 3rem; } h1 { font-size: 1.5rem; overflow-wrap: anywhere; } p { overflow-wrap: anywhere; }
}
@media print {
  html { font-size: 11px; overflow: visible; } body { font-size: 1rem; } main { max-width: none; padding: 0; } nav { display: none; } h2 { margin-top: 1.5rem; }
  figure, tr { break-inside: avoid; } .scroll { overflow: visible; }
  .panels { grid-template-columns: minmax(0, 1fr); } .panel { max-width: 44rem; }
}
"""
# Figures know their width only when they are drawn: paper is narrower than most screens.
_FIT_TO_PAPER = """
addEventListener("beforeprint", () => document.querySelectorAll(".js-plotly-plot").forEach(p => Plotly.Plots.resize(p)));
"""
# A point that stands for a case has the case's id with it, and one of a page of set-ups the set-up's name.
_OPEN_CASES = """
addEventListener("DOMContentLoaded", () => document.querySelectorAll("[data-cases] .js-plotly-plot").forEach(plot =>
  plot.on("plotly_click", event => {
    const id = event.points[0].customdata;
    const place = plot.closest("[data-cases]").dataset;
    if (place.setUps && /^[0-9A-Za-z_-]+$/.test(id)) location.href = `${place.setUps}#${id}`;
    else if (/^[0-9a-f]{16}$/.test(id)) location.href = `${place.cases}/${id}/case.html`;
  })));
"""
_HEIGHT = 400
# The mark of the inputs stands in the first lines of a page whose script takes megabytes.
_MARK_WITHIN = 1000


def document(title: str, inputs: str, body: Iterable[str], script: str | None = None) -> str:
    """The whole page. `inputs`, the hash of what it was made from, is kept in its head. plotly.js is the file `script`, named as
    seen from the page; it is put into the page where that is None, and left out where it is empty."""
    return "\n".join(
        [
            '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">',
            inputs_mark(inputs),
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f"<title>{escape(title)}</title>",
            f"<style>{_STYLE}</style>",
            *_scripts(script),
            "</head>\n<body>\n<main>",
            *body,
            "</main>\n</body>\n</html>\n",
        ]
    )


def provide_script(folder: Path) -> None:
    """Put plotly.js into a folder of results, unless it is there."""
    text, target = get_plotlyjs(), folder / SCRIPT
    if not target.is_file() or target.stat().st_size != len(text.encode()):
        write_text(target, text)


def inputs_mark(inputs: str) -> str:
    """The line in a page's head by which a later run sees that the page is up to date."""
    return f'<meta name="made-from" content="{inputs}">'


def is_current(page: Path, inputs: str) -> bool:
    """Whether a page was made from just these inputs."""
    if not page.is_file():
        return False
    with page.open(encoding="utf-8") as file:
        return inputs_mark(inputs) in file.read(_MARK_WITHIN)


def section(title: str, *parts: str) -> str:
    return f"<section>\n<h2>{escape(title)}</h2>\n" + "\n".join(parts) + "\n</section>"


def plot_section(plot: Plot) -> str:
    """A plot with its finding above and its explanation below."""
    parts = [finding(plot.finding), figures(plot.panels)]
    if plot.explanation:
        parts.append(soft(plot.explanation))
    return section(plot.title, *parts)


def figures(panels: list[Panel], cases: str = CASES, set_ups: str = "") -> str:
    """Panels side by side. `cases` is the folder of the cases that their points open, as seen from the page; where they open set-ups
    that are all on one page (analysis.report.set_ups_page), `set_ups` is its file."""
    drawn = "\n".join(
        f'<figure class="panel"><figcaption>{escape(panel.caption)}</figcaption>{_figure(panel.figure)}</figure>'
        for panel in panels
    )
    # Said by a class, since a figure is drawn while the page is still being read and its siblings are unknown.
    kind = "panels single" if len(panels) == 1 else "panels"
    one_page = f' data-set-ups="{escape(set_ups)}"' if set_ups else ""
    return f'<div class="{kind}" data-cases="{cases}"{one_page}>{drawn}</div>'


def finding(text: str) -> str:
    return f'<p class="finding">{escape(text)}</p>'


def paragraph(text: str) -> str:
    return f"<p>{escape(text)}</p>"


def soft(text: str) -> str:
    return f'<p class="soft">{escape(text)}</p>'


def code(text: str) -> str:
    return f"<code>{escape(text)}</code>"


def link(target: str, text: str) -> str:
    """To a file, relative to the page."""
    return f'<a href="{escape(target)}">{escape(text)}</a>'


def case_link(case: str, cases: str = CASES) -> str:
    """To a case's page."""
    return f'<a href="{cases}/{case}/{CASE_PAGE}"><code>{escape(case)}</code></a>'


def command(text: str) -> str:
    """A command on a line of its own, which may be long."""
    return f'<code class="command">{escape(text)}</code>'


def folded(summary: str, content: str) -> str:
    """Content that is opened by a click, for what few readers need."""
    return f"<details><summary>{escape(summary)}</summary>\n{content}\n</details>"


def table(
    header: list[str], rows: list[list[str]], text_columns: int = 1, strong: frozenset[int] = frozenset()
) -> str:
    """A table of cells that are HTML already; the first `text_columns` are set left, the rest, numbers, right."""
    kinds = ['class="text"' if index < text_columns else "" for index in range(len(header))]
    head = "".join(f"<th {kind}>{escape(cell)}</th>" for kind, cell in zip(kinds, header))
    lines = [
        f'<tr{" class=strong" if number in strong else ""}>'
        + "".join(f"<td {kind}>{cell}</td>" for kind, cell in zip(kinds, row))
        + "</tr>"
        for number, row in enumerate(rows)
    ]
    return (
        f'<div class="scroll"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n'
        + "\n".join(lines)
        + "\n</tbody></table></div>"
    )


def _scripts(script: str | None) -> list[str]:
    if script == "":
        return []
    whole = f"<script>{get_plotlyjs()}</script>" if script is None else f'<script src="{script}"></script>'
    return [whole, f"<script>{_FIT_TO_PAPER}{_OPEN_CASES}</script>"]


def _figure(figure: Any) -> str:
    """The figure's place and the script that draws it there. Everything is styled by `plot.figure`: plotly's template, longer than
    most figures, is left out."""
    content = figure.to_plotly_json()
    layout = {key: value for key, value in content["layout"].items() if key != "template"}
    config = {"responsive": True, "displaylogo": False, "displayModeBar": False}
    parts = ", ".join(
        json.dumps(part, cls=PlotlyJSONEncoder, separators=(",", ":"))
        for part in (content["data"], layout, config)
    )
    # What ends a script element in HTML must not stand in one.
    harmless = parts.replace("</", "<\\/")
    place = f'<div class="{PLOT}" style="height:{layout.get("height", _HEIGHT)}px"></div>'
    return (
        f"{place}<script>Plotly.newPlot(document.currentScript.previousElementSibling, {harmless});</script>"
    )
