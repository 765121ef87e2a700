"""The first figure: errors in the change of a reading, by machine, with mutual and delta_self beside it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from analysis.report import plots_of_errors
from analysis.report.plot import Panel, Plot
from analysis.results import study_results as results, table
from analysis.results.table import DELTA_SELF, MUTUAL
from analysis.study import report
from tests.analysis.synthetic import MACHINES, MACHINE_ANSWERS, make_results, report_text


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return make_results(tmp_path, MACHINES, MACHINE_ANSWERS)


def plot(folder: Path) -> Plot:
    return plots_of_errors.error_of_changes(table.rows(results.load(folder)))


def points(panel: Panel) -> dict[str, tuple[Any, Any]]:
    return {trace.name: (list(trace.x), list(trace.y)) for trace in panel.figure.data}


def test_the_change_is_drawn_by_machine_with_mutual_and_delta_self_beside_it(folder: Path) -> None:
    change, mutual, delta_self = plot(folder).panels
    assert [panel.caption for panel in (mutual, delta_self)] == ["mutual", "delta_self"]
    # 1.8 pF instead of 1 pF and of 0.8 pF; the model knows no change with a guard and none of a floating target.
    found = points(change)
    assert found["no machine"] == (pytest.approx([1.0]), pytest.approx([80.0]))
    assert found["housing"] == (pytest.approx([0.8]), pytest.approx([125.0]))
    assert set(found) == {"no machine", "housing"}
    assert points(mutual)["housing+guard"] == (pytest.approx([1.7]), pytest.approx([100 / 17]))
    assert set(points(delta_self)) == {"no machine"}


def test_machines_differ_in_colour_and_symbol(folder: Path) -> None:
    change, mutual, _ = plot(folder).panels
    markers = {trace.name: (trace.marker.color, trace.marker.symbol) for trace in mutual.figure.data}
    colours, symbols = zip(*markers.values())
    assert len(set(colours)) == len(set(symbols)) == 3
    assert all(markers[trace.name][0] == trace.marker.color for trace in change.figure.data)


def test_the_finding_tells_the_error_by_machine_and_how_many_are_left_out(folder: Path) -> None:
    finding = plot(folder).finding
    assert finding.startswith(
        "In the change of a reading the model is 125 % too high with housing (one case), 80 % too high without a machine (one case)"
    )
    assert finding.endswith("The model knows no value of 2 more.")


def test_without_machines_delta_self_is_the_change_and_is_drawn_once(tmp_path: Path) -> None:
    change, mutual = plot(make_results(tmp_path)).panels
    assert list(points(change)) == ["no machine"] and mutual.caption == "mutual"
    assert len(points(change)["no machine"][0]) == 5


def test_it_is_the_first_figure_of_the_report_and_its_points_open_their_cases(folder: Path) -> None:
    text = report.make(folder).path.read_text(encoding="utf-8")
    first = text.index("plotly-graph-div", text.index("<body>"))
    assert text.index(plots_of_errors.TITLE) < first
    told = [
        text.index(f">{where}: the model is")
        for where in ("On machines, change of the reading", MUTUAL, DELTA_SELF)
    ]
    assert told == sorted(told)
    assert 'data-cases="cases"' in text
    for case in results.load(folder).compared():
        assert (f'"{case.id}"' in text) == (case.model is not None)


def test_every_page_is_made_where_the_model_knows_no_value(folder: Path) -> None:
    text = report_text(folder)
    pages = [case.folder / "case.html" for case in results.load(folder).compared()]
    assert (
        "change of sensor: 0.100 ± 0.010 pF by the field solver (estimated error); the model has no answer."
        in pages[3].read_text()
    )
    assert (
        "change of sensor: 0.900 ± 0.010 pF by the field solver (estimated error); the model has no answer."
        in pages[2].read_text()
    )
    # Where the model has an answer, targets are coloured by what each part adds.
    assert ["fF/cm²" in page.read_text() for page in pages] == [True, True, True, False]
    assert ["machine (grey)" in page.read_text() for page in pages] == [False, True, True, True]
    assert "to ground 100 pF, machine housing" in pages[3].read_text()
    assert "rows of change" in text


def test_a_study_of_which_the_model_knows_nothing_has_a_report_too(tmp_path: Path) -> None:
    answers = {number: (reference, None) for number, (reference, _) in MACHINE_ANSWERS.items()}
    text = report_text(make_results(tmp_path, MACHINES, answers))
    assert plots_of_errors.TITLE not in text and "rows of change" in text
