"""The parts of pages: plain text is escaped, parts that are HTML already are not, and all HTML is in the templates."""

from __future__ import annotations

import re
from pathlib import Path

import plotly.graph_objects as go
from markupsafe import Markup

import analysis
from analysis.report import index_page, page
from analysis.report.plot import Panel

HOSTILE = "<b>&\"'</b>"
_NAMES = "a|code|details|div|figure|h[1-6]|header|li|meta|nav|p|script|section|small|span|strong|style|summary|table|td|th|tr|ul"
_ELEMENT = re.compile(rf"</?(?:{_NAMES})(?: [a-z-]+=[^>]*)?>")


def test_plain_text_is_escaped_in_every_part() -> None:
    parts = [
        page.section(HOSTILE, page.paragraph(HOSTILE), page.finding(HOSTILE), page.soft(HOSTILE)),
        page.header(HOSTILE, page.heading(HOSTILE)),
        page.navigation(page.link(HOSTILE, HOSTILE)),
        page.table([HOSTILE], [[HOSTILE], [page.code(HOSTILE)], [page.two_lines(HOSTILE, HOSTILE)]]),
        page.folded(HOSTILE, page.command(HOSTILE)),
        page.case_link(HOSTILE, HOSTILE),
        page.beside([page.paragraph(HOSTILE)], [page.soft(HOSTILE)]),
        page.filled(
            "index.html",
            title=HOSTILE,
            warning="",
            headline="",
            answers=[index_page.Answer(HOSTILE, HOSTILE, [index_page.Picture(HOSTILE, Markup(""), HOSTILE)])],
            own=[index_page.Card(HOSTILE, HOSTILE, HOSTILE)],
            others=[index_page.Card(HOSTILE, HOSTILE, HOSTILE)],
            rest=[],
        ),
    ]
    text = page.document(HOSTILE, "inputs", parts, "")
    assert "<b>" not in text and "&lt;b&gt;&amp;" in text


def test_a_part_in_another_is_taken_as_it_is() -> None:
    text = page.section("title", page.table(["a"], [[page.strong("no")], [page.yes_or_no(True)]]))
    assert '<td class="text"><strong>no</strong></td>' in text and ">yes</td>" in text


def test_numbers_have_a_minus_sign_and_commands_a_hyphen() -> None:
    text = page.table(
        ["a"], [["-3.5 %", "+2 (-1 to -0.5)"], [page.code("--rtol 1e-3 -5"), "tree:1e-6 2026-11-23"]]
    )
    assert "−3.5 %" in text and "+2 (−1 to −0.5)" in text
    assert "--rtol 1e-3 -5" in text and "tree:1e-6 2026-11-23" in text


def test_the_picture_of_a_page_is_its_first_figure_with_enough_points() -> None:
    few, many = (
        Panel("", go.Figure(go.Scatter(x=list(range(n)), y=[1.0] * n, mode="markers"))) for n in (2, 12)
    )
    assert index_page.first_picture(page.figures([few, many]), "a page").count("<circle") == 12
    assert index_page.first_picture(page.figures([few]), "a page").count("<circle") == 2
    assert index_page.first_picture(page.paragraph("no figure"), "a page") == ""


def test_data_cannot_end_the_script_that_holds_them() -> None:
    assert "</script" not in page.json_in_page('{"name": "</script><script>"}')


def test_a_page_is_current_only_for_the_inputs_that_it_was_made_from(tmp_path: Path) -> None:
    file = tmp_path / "page.html"
    assert not page.is_current(file, "one")
    file.write_text(page.document("title", "one", []))
    assert page.is_current(file, "one") and not page.is_current(file, "two")


def test_the_python_files_hold_no_html() -> None:
    folder = Path(analysis.__file__).parent
    found = {
        path.relative_to(folder).as_posix(): _ELEMENT.findall(line)
        for path in folder.rglob("*.py")
        for line in path.read_text(encoding="utf-8").splitlines()
        if _ELEMENT.search(line)
    }
    # The mark by which a page is found up to date, and the search for the first finding of a page.
    assert found.keys() <= {"report/page.py", "report/index_page.py"}
