"""The parts of pages: plain text is escaped, parts that are HTML already are not, all HTML is in the templates, and figures have their
numbers beside them. The first screen of a report, and the list of everything that was made."""

import csv
import re
from pathlib import Path

import plotly.graph_objects as go
import pytest
from markupsafe import Markup

import analysis
from analysis import commands
from analysis.report import index_page, page
from analysis.report.index_page import Answer
from analysis.report.plot import Panel, axis, figure, guide, joined, log_axis
from analysis.results import study_results as results, table
from analysis.results.store import write_text
from analysis.study import report
from tests.analysis.documents import boundary_document, model_document, reference_document
from tests.analysis.synthetic import EDGE, MACHINES, MACHINE_ANSWERS, PARALLEL, make_results

BODY = go.Mesh3d(x=[0, 1, 0], y=[0, 0, 1], z=[0, 0, 0])


def lines(figure_: go.Figure, folder: Path) -> list[list[str]]:
    """The data of a figure that a page shows."""
    shown = page.figures([Panel("The model's error, in % of all that there is here", figure_)])
    page.write(folder / "errors.html", page.document("Errors", "", [shown], ""))
    (target,) = re.findall(r'href="(.*?)" download>CSV', (folder / "errors.html").read_text())
    assert target == "data/errors/1_the_model_s_error_in_of.csv"
    return list(csv.reader((folder / target).read_text(encoding="utf-8").splitlines()))


def test_points_have_their_series_their_errors_and_their_case(tmp_path: Path) -> None:
    cases, notes = ["0123456789abcdef", "a"], ["first<br>of two", ""]
    trace = joined("a", [1, 2], [3.5, 4.5], "red", "%{y}", [0.1, 0.2], customdata=cases, text=notes)
    found = lines(figure([trace, guide("limit", [1, 2], [4, 4])], log_axis("gap (cm)"), axis("")), tmp_path)
    assert found == [
        ["series", "gap (cm)", "y", "error", "note", "set-up"],
        ["a", "1", "3.5", "0.1", "first; of two", "0123456789abcdef"],
        ["a", "2", "4.5", "0.2", "", "a"],
        ["limit", "1", "4", "", "", ""],
        ["limit", "2", "4", "", "", ""],
    ]


def test_a_map_has_a_line_for_each_cell(tmp_path: Path) -> None:
    trace = go.Heatmap(x=["1", "2"], y=["a"], z=[[5, None]], text=[["one", ""]], customdata=[["id", ""]])
    found = lines(figure([trace], axis("size"), axis("gap")), tmp_path)
    assert found == [
        ["series", "size", "gap", "value", "note", "set-up"],
        ["", "1", "a", "5", "one", "id"],
        ["", "2", "a", "", "", ""],
    ]


@pytest.mark.parametrize(("shown", "with_data"), [(go.Figure(BODY), True), (go.Figure(go.Scatter()), False)])
def test_bodies_in_space_and_pictures_of_cases_have_none(
    shown: go.Figure, with_data: bool, tmp_path: Path
) -> None:
    text = page.figures([Panel("drawn", shown)], with_data=with_data)
    page.write(tmp_path / "page.html", text)
    assert "CSV" not in text and [path.name for path in tmp_path.iterdir()] == ["page.html"]


def test_data_of_figures_that_are_gone_go(tmp_path: Path) -> None:
    trace = joined("a", [1], [2], "red", "")
    lines(figure([trace], axis("x"), axis("y")), tmp_path)
    page.write(tmp_path / "errors.html", "no figure")
    assert not (tmp_path / "data" / "errors").exists()


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


def answers(folder: Path) -> list[Answer]:
    found = results.load(folder)
    return index_page.how_wrong(found, table.rows(found), "cases")


def test_each_family_is_told_by_where_the_target_is(tmp_path: Path) -> None:
    known = {
        number: (reference_document(2, 1), model_document(value))
        for number, value in enumerate((1.2, 1.4, 0.9, 26.0, 30.0))
    }
    facing, beside = answers(make_results(tmp_path, PARALLEL + EDGE, known))
    assert (facing.question, beside.question) == ("Facing a plate", "Beside an edge")
    assert (
        facing.says
        == "The model's change of the reading is mostly 20 % off, at worst 40 % too high (of 3 values)."
    )
    assert beside.says == (
        "The model's change of the reading is mostly 28 times too high, at worst 30 times too high (of 2 values)."
    )


def test_machines_are_one_question_with_a_picture_of_each(tmp_path: Path) -> None:
    alone, machine = answers(make_results(tmp_path, MACHINES, MACHINE_ANSWERS))
    assert alone.question == "Facing a plate" and len(alone.pictures) == 1
    assert machine.question == "On a machine"
    assert [picture.words for picture in machine.pictures] == [
        "parallel, housing",
        "parallel, housing and guard",
    ]
    assert machine.says == "The model's change of the reading is 125 % too high."


def test_where_the_model_knows_nothing_this_is_said(tmp_path: Path) -> None:
    unknown = {number: (reference, None) for number, (reference, _) in MACHINE_ANSWERS.items()}
    assert {each.says for each in answers(make_results(tmp_path, MACHINES, unknown))} == {
        "The model has no answer here."
    }


def test_the_first_screen_has_no_symbols_and_says_what_speaks_for_the_reference(tmp_path: Path) -> None:
    both = {number: boundary_document(2.002, 1.003) for number in range(5)}
    text = report.make(make_results(tmp_path, boundary=both)).path.read_text()
    (first,) = re.findall(r'<ul class="answers">(.*?)</ul>', text, re.DOTALL)
    words = re.sub(r"<svg.*?</svg>|<[^>]*>", "", first, flags=re.DOTALL)
    assert "agree within the errors that they state in 20 of 20 values" in words
    assert not re.search(r"delta_self|mutual|rms|M\[|ε", words)
    assert 'href="report/cross_check.html"' in first
    assert text.index("What the words mean") > text.index('<ul class="answers">')


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, title in (("default/report", "A < B"), ("default/trends", "Trends"), ("sweep/arm", "Arm")):
        write_text(tmp_path / f"{name}.html", page.document(title, "inputs", [], ""))
    for other in ("default/table.csv", "default/study.json", "default/cases/1/case.html", "coverage/arm.vtu"):
        write_text(tmp_path / other, "")
    write_text(
        tmp_path / "documentation" / "analysis" / "documentation" / "index.html", "<title>Notes</title>"
    )
    return tmp_path


def test_each_page_and_table_is_listed_once(folder: Path) -> None:
    made = index_page.make(folder)
    assert made == folder / "index.html"
    listed = re.findall(r'<a href="(.*?)">(.*?)</a>', made.read_text(encoding="utf-8"))
    assert listed == [
        ("coverage/arm.vtu", "arm.vtu"),
        ("default/report.html", "A &lt; B"),
        ("default/trends.html", "Trends"),
        ("default/table.csv", "table.csv"),
        ("documentation/analysis/documentation/index.html", "Notes"),
        ("sweep/arm.html", "Arm"),
    ]
    assert all((folder / target).is_file() for target, _ in listed)


def test_it_is_written_again_when_something_was_made(folder: Path) -> None:
    made = index_page.make(folder)
    assert made is not None
    before = made.stat().st_mtime_ns
    assert index_page.make(folder) == made and made.stat().st_mtime_ns == before
    write_text(folder / "live" / "head.html", "no title")
    index_page.make(folder)
    assert 'href="live/head.html">head.html' in made.read_text(encoding="utf-8")


def test_there_is_none_where_nothing_was_made(tmp_path: Path) -> None:
    assert index_page.make(tmp_path) is None and index_page.make(tmp_path / "nowhere") is None
    assert not list(tmp_path.iterdir())


def test_a_command_brings_it_up_to_date(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(commands.installation, "results_folder", lambda: folder)
    monkeypatch.setitem(commands._COMMANDS, "show", lambda _: 3)
    assert commands.run_command(type("Options", (), {"command": "show", "output": None})()) == 3  # type: ignore[arg-type]
    assert (folder / "index.html").is_file()
