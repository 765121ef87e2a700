"""The report: every plot with its finding, what failed, what is short of the accuracy, offline, rebuilt only when needed."""

import re
from pathlib import Path

import pytest
from markupsafe import escape

from analysis.report.index_page import LIVE, MOTION
from analysis.report.page import SCRIPT
from analysis.results import store, study_results as results, table
from analysis.results.study_results import Failure
from analysis.study import report
from analysis.study.report import QUESTIONS
from analysis.topics.corrections import topic
from analysis.topics.corrections.topic import CORRECTIONS
from analysis.topics.trends import changes, page as trends_page
from geometries.common.errors import InputError
from tests.analysis.documents import model_document, reference_document
from tests.analysis.synthetic import corrections_document, enclosed, make_results, report_text
from tests.waiting import aged


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return make_results(tmp_path)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of results with its report, which no test alters."""
    folder = make_results(tmp_path_factory.mktemp("made"))
    report.make(folder)
    return folder


PLOTS = (
    "Model against reference",
    *(f"Model error over {name}" for name in ("gap/size", "tilt", "lateral offset", "size ratio")),
)


def test_every_plot_has_a_figure_and_a_finding(made: Path) -> None:
    text = report_text(made)
    for title in PLOTS:
        (section,) = re.findall(rf"<section>\s*<h2>{re.escape(title)}</h2>(.*?)</section>", text, re.DOTALL)
        (finding,) = re.findall(r'<p class="finding">(.*?)</p>', section)
        assert finding.endswith(".") and len(finding) > 30
        assert "plotly-graph-div" in section


TOLD = (
    "mutual: the model is 10 % off (rms over 5 cases), median 10 %, worst 10 % too low",
    "delta_self: the model is 80 % off (rms over 5 cases), median 80 %, worst 80 % too high",
    *("sure to 0.5 % or better", "dolfinx", "0.5.2", "processor", "cores"),
)


@pytest.mark.parametrize("words", TOLD)
def test_the_report_tells_errors_versions_and_machine(made: Path, words: str) -> None:
    assert words in report_text(made)


def pages_of(folder: Path) -> list[Path]:
    """Every page that there is, the report first."""
    return [report.make(folder).path, *sorted(folder.rglob("*/*.html"))]


def test_every_question_has_a_page_that_the_report_leads_to_with_its_finding(made: Path) -> None:
    text = (made / "report.html").read_text()
    asked = [question for question in QUESTIONS if question.name != "experiment"]
    cards = re.findall(r'<a href="(report/[^"]*)">([^<]*)</a><p>(.*?)</p></li>', text)
    assert [title for _, title, _ in cards] == [escape(question.title) for question in asked if question.own]
    for target, title, finding in cards:
        page = (made / target).read_text()
        assert f"<h1>{title}</h1>" in page and finding in page
    (others,) = re.findall(r"<h2>Other set-ups, measured once</h2>(.*?)</section>", text, re.DOTALL)
    for question in asked:
        assert (f'href="report/{question.name}.html"' in others) != question.own


def test_the_first_page_draws_each_family_and_leads_to_its_first_case(made: Path) -> None:
    text = (made / "report.html").read_text()
    (drawn,) = re.findall(r"<header>(.*?)</header>", text, re.DOTALL)
    compared = results.load(made).compared()
    families = list(dict.fromkeys(case.family for case in compared))
    assert drawn.count("<svg") == len(families)
    for family in families:
        first = next(case for case in compared if case.family == family)
        assert f'href="cases/{first.id}/case.html"' in drawn and f'aria-label="{first.name}"' in drawn


def test_every_page_leads_only_to_files_that_are_there(made: Path) -> None:
    pages = pages_of(made)
    assert (
        len(pages) == 1 + 13 + 1 + 6
    )  # the report, the questions, the published set-ups, the cases with the sensor alone
    for page in pages:
        targets = re.findall(r'(?:href|src)="([^"]*)"', page.read_text())
        assert targets
        for target in targets:
            assert (page.parent / target).is_file(), f"{page}: {target}"


def test_the_script_is_there_once_and_pages_are_light(made: Path) -> None:
    pages = pages_of(made)
    scripts = [path for path in made.rglob("*") if path.is_file() and path.stat().st_size > 1_000_000]
    assert scripts == [made / SCRIPT]
    assert "plotly.js v" in scripts[0].read_text()
    assert f'<script src="{SCRIPT}">' in pages[0].read_text()


def test_points_open_their_case(made: Path) -> None:
    page = (made / "report" / "model_error.html").read_text()
    for case in results.load(made).compared():
        assert f'"{case.id}"' in page
    cases = set(re.findall(r'data-cases="(.*?)"', page))
    assert cases == {"../cases"} and "plotly_click" in page
    opening = {
        path.name
        for path in (made / "report").glob("*.html")
        if "A click on a point opens its case." in path.read_text()
    }
    assert opening == {"model_error.html"}


def test_the_page_of_a_case_has_its_drawing_its_numbers_and_its_commands(made: Path) -> None:
    for case in results.load(made).compared():
        page = (case.folder / "case.html").read_text()
        assert page.count("plotly-graph-div") == 1 and "No slice of its potential is stored" in page
        assert (
            "mutual of sensor and target: 2.000 ± 0.010 pF by the field solver (estimated error); the model is −10.00 % off"
            in page
        )
        assert f"cases/{case.id}/scene.toml --rtol 0.001 --max-seconds 60" in page
        assert f"cases/{case.id}/scene.toml --method exact" in page
        assert 'href="fem.json"' in page


def test_points_of_the_published_table_open_its_set_ups_on_one_page(made: Path) -> None:
    page = (made / "report" / "published.html").read_text()
    assert 'data-set-ups="set_ups/published.html"' in page and "A click on a point opens its set-up." in page
    opened = (made / "report" / "set_ups" / "published.html").read_text()
    assert 'href="../published.html"' in opened
    points = set(re.findall(r'"([0-9a-f]{16})"', page))
    assert len(points) == 530 and all(f'"name":"{point}"' in opened for point in points)


def test_pages_of_set_ups_are_made_again_only_when_what_they_show_has_changed(tmp_path: Path) -> None:
    folder = make_results(tmp_path / "results")
    corrections = CORRECTIONS.beside(folder) / topic.DOCUMENT
    document = corrections_document()
    store.write_json(corrections, document)
    report.make(folder)
    pages = [folder / "report" / "set_ups" / f"{name}.html" for name in ("corrections", "published")]
    before = [aged(page) for page in pages]
    (folder / "report.html").unlink()
    (folder / "report" / "pages.json").unlink()
    report.make(folder)
    assert [page.stat().st_mtime_ns for page in pages] == before
    store.write_json(corrections, {**document, "sealed": 2})
    report.make(folder)
    after = [page.stat().st_mtime_ns for page in pages]
    assert after[0] != before[0] and after[1] == before[1]


def test_only_the_report_and_the_page_of_a_case_that_changed_are_made_again(folder: Path) -> None:
    made = aged(report.make(folder).path)
    first, second, *_ = results.load(folder).compared()
    before = [aged(case.folder / "case.html") for case in (first, second)]
    assert report.make(folder).path.stat().st_mtime_ns == made
    store.write_json(first.folder / results.MODEL, model_document(1.7))
    assert report.make(folder).path.stat().st_mtime_ns != made
    after = [(case.folder / "case.html").stat().st_mtime_ns for case in (first, second)]
    assert after[0] != before[0] and after[1] == before[1]
    (folder / table.TABLE).unlink()
    report.make(folder)
    assert (folder / table.TABLE).is_file()


def test_a_page_that_is_gone_is_made_again_and_one_of_no_question_removed(folder: Path) -> None:
    report.make(folder)
    (folder / "report" / "stability.html").unlink()
    report.make(folder)
    assert (folder / "report" / "stability.html").is_file()
    (folder / "report" / "outdated.html").write_text("")
    (folder / "report" / "pages.json").unlink()
    (folder / "report.html").unlink()
    report.make(folder)
    assert not (folder / "report" / "outdated.html").exists()


def test_a_night_changes_the_report_alone(folder: Path) -> None:
    report.make(folder)
    page = (folder / "report" / "model_error.html").stat().st_mtime_ns
    changes.add(folder, changes.of_night(folder))
    for target in re.findall(r'(?:href|src)="([^"]*)"', trends_page.make(folder).read_text()):
        assert (folder / target).is_file()
    text = report.make(folder).path.read_text()
    assert 'href="trends.html"' in text and "values over 1 commits: none has changed" in text
    assert (folder / "report" / "model_error.html").stat().st_mtime_ns == page


def test_failed_cases_are_listed_with_their_reason(tmp_path: Path) -> None:
    answers = {0: (None, model_document(1))}
    case, *_ = results.load(make_results(tmp_path, answers=answers)).compared()
    failure = Failure(case.id, "reference", "exit code 2: <no mesh>")
    text = report_text(make_results(tmp_path, answers=answers, failures=[failure]))
    assert "Failed cases" in text
    assert f'<td class="text">{case.name}</td>' in text and "exit code 2: &lt;no mesh&gt;" in text


def test_cases_short_of_the_asked_accuracy_are_named_and_counted(tmp_path: Path) -> None:
    folder = make_results(
        tmp_path, answers={0: (reference_document(2, 1, reached=False), model_document(1.8))}
    )
    assert report.make(folder).not_reached == 1
    assert "5 of 6 solves reached the asked relative accuracy" in report_text(folder)
    assert "Short of it" in report_text(folder)


def test_enclosures_are_told_from_estimates(tmp_path: Path) -> None:
    answers = {0: (enclosed(reference_document(2, 1), 0.02, 0), model_document(1.8))}
    text = report_text(make_results(tmp_path, answers=answers))
    assert "In 1 solves the truth is enclosed" in text and "the mutual one to within 1.0e-02" in text
    assert "the truth is enclosed" not in report_text(make_results(tmp_path / "other"))


def test_the_two_ways_to_delta_self_are_counted(tmp_path: Path) -> None:
    disagreeing = reference_document(2, 1)
    disagreeing["delta_self"]["sensor"]["value"] = 1.5e-12
    folder = make_results(tmp_path, answers={0: (disagreeing, model_document(1.8))})
    assert (
        "4 of 5 cases agree within the sum of their errors; the largest difference is 0.5 pF"
        in report_text(folder)
    )


def test_the_first_page_leads_to_a_case_that_has_the_potential_around_it(folder: Path) -> None:
    case = results.load(folder).compared()[1]
    plane = {"origin": [0.0, 0.0], "direction": [1.0, 0.0]}
    slice_of = plane | {"along": [-0.1, 0.1], "z": [-0.1, 0.1], "potential": [[0.1, 0.2], [0.3, 0.4]]}
    store.write_json(case.folder / results.SLICE, {"key": "", **slice_of})
    text = report.make(folder).path.read_text()
    (drawn,) = re.findall(r"<header>(.*?)</header>", text, re.DOTALL)
    assert f'href="cases/{case.id}/case.html"' in drawn and f'aria-label="{case.name}"' in drawn
    page = (case.folder / "case.html").read_text()
    assert "potential (V) in the vertical plane through both centres" in page


def test_pages_of_scenes_beside_the_results_are_linked(tmp_path: Path) -> None:
    folder = make_results(tmp_path / "default")
    report.make(folder)
    for each in (LIVE, MOTION):
        file = folder.parent / each.folder / f"{each.scene}.html"
        file.parent.mkdir()
        file.touch()
    text = report.make(folder).path.read_text()
    for each in (LIVE, MOTION):
        assert f'href="../{each.folder}/{each.scene}.html"' in text and each.title in text


def test_results_without_a_single_answer_still_give_a_report(tmp_path: Path) -> None:
    folder = make_results(tmp_path, answers={number: (None, None) for number in range(5)})
    assert report.make(folder).summaries == []
    assert "Every row" in report_text(folder)


def test_a_folder_without_results_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no results"):
        report.make(tmp_path)
