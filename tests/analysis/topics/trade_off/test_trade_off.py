"""Run time against error of everything that answers: what is measured, what becomes of it, where it is shown."""

from pathlib import Path
from typing import Any

import pytest

from analysis.pipeline.model_stage import model_module
from analysis.report import plots_of_errors
from analysis.report.page import PLOT, SCRIPT
from analysis.results import store, study_results as results
from analysis.results.study_results import Results
from analysis.study import report
from analysis.topics.trade_off import measure, section
from tests.analysis.documents import PICO
from tests.analysis.synthetic import PARALLEL, make_results

ONE = PARALLEL.replace("[0.01, 0.02, 0.04]", "0.04")


def document(found: Results, **errors: float) -> dict[str, Any]:
    """A measurement: the truth is 2 pF in every case; relative errors and microseconds by method, the latter 1, 2, 3 …"""
    cases = [case.id for case in found.compared()]
    kinds = {"exact": "model", "split:0": "thesis", "formula": "formula", "reduced 1e-3": "reduced"}
    return {
        "truth_rtol": 3e-6,
        "processor": "made up",
        "instruction_sets": "none",
        "truths": {case: {"mutual": 2 * PICO, "error": 2e-6 * PICO, "reached": True} for case in cases},
        "methods": [
            {
                "kind": kinds[name],
                "name": name,
                "values": {case: 2 * PICO * (1 + error) for case in cases},
                "seconds": {case: 1e-6 * number for case in cases},
            }
            for number, (name, error) in enumerate(errors.items(), start=1)
        ],
    }


ERRORS = {"split:0": -0.3, "exact": -0.2, "formula": 0.02, "reduced 1e-3": 1e-4}


@pytest.fixture
def found(tmp_path: Path) -> Results:
    return results.load(make_results(tmp_path))


def test_every_method_of_the_module_answers_and_is_timed_and_solvers_meet_the_error_asked_for(
    tmp_path: Path,
) -> None:
    """One pair of plates, measured by the module of the build; the plain model is off."""
    measured = measure.measured(model_module(), results.load(make_results(tmp_path, ONE)).compared())
    (truth,) = measured["truths"].values()
    off = {}
    for entry in measured["methods"]:
        ((seconds,), (value,)) = entry["seconds"].values(), entry["values"].values()
        assert seconds > 0
        off[entry["name"]] = abs(value / truth["mutual"] - 1)
    assert set(off) == {f"split:{n}" for n in range(9)} | {"exact", "formula"} | {
        *("reduced 1e-2", "reduced 1e-3", "reduced 3e-4"),
        *("1e-2", "1e-3", "1e-4", "1e-5"),
    }
    assert off["1e-2"] < 1e-2 and off["1e-5"] < 1e-5 and off["reduced 3e-4"] < 3e-4
    assert off["split:8"] == pytest.approx(off["exact"], rel=1e-3) and off["exact"] > 0.05


def test_points_are_medians_and_meshes_those_that_most_cases_came_to(found: Results) -> None:
    """The reference says 2 pF; its first mesh is 10 % above after 1.5 s, its second at it after 3 s."""
    made = section.points(document(found, **ERRORS), found)
    told = [(point.name, point.seconds, round(point.error, 9)) for point in made]
    assert told == [
        ("split:0", 1e-6, 0.3),
        ("exact", 2e-6, 0.2),
        ("formula", 3e-6, 0.02),
        ("reduced 1e-3", 4e-6, 1e-4),
        ("1", 1.5, 0.1),
        ("2", 3.0, 0.0),
        ("answer", 4.5, 0.0),
    ]
    assert section.known_to(document(found, **ERRORS)) == pytest.approx(1e-6)
    assert section.agreement(document(found, **ERRORS), found) == (5, 5)


def test_a_point_opens_the_case_in_which_its_method_is_worst(found: Results) -> None:
    told = document(found, **ERRORS)
    worst = found.compared()[2].id
    told["methods"][1]["values"][worst] *= 0.5
    made = section.points(told, found)
    assert {point.name: point.worst for point in made}["exact"] == worst
    text = section.section(told, found, "cases")
    assert 'data-cases="cases"' in text and f'"customdata":["{worst}"]' in text


def test_the_front_ends_where_the_truth_is_known_to(found: Results) -> None:
    made = section.points(document(found, **ERRORS), found)
    named = {point.seconds: point.name for point in made}
    drawn, *_ = section.plot(made, 1e-6).data
    assert [named[seconds] for seconds in drawn.x] == ["split:0", "exact", "formula", "reduced 1e-3", "2"]


def test_the_finding_is_computed(found: Results) -> None:
    told = document(found, **ERRORS)
    sentence = section.finding(section.points(told, found), told)
    assert "Over 5 set-ups the plain model takes 2 µs and is 20 % off" in sentence
    assert "the formula 3 µs and 2 %, reduced 1e-3 4 µs and 0.01 %" in sentence
    assert "mesh 1 of the field solver is 10 % off after 1.5 s, 400,000 times as long" in sentence
    assert "spans 6.7 decades" in sentence


def test_the_fastest_method_for_each_accuracy_is_told_in_words(found: Results) -> None:
    assert section.advice(document(found, **ERRORS), found) == (
        "For an error of at most 10 %: the formula, 3 µs a pose; 1 % or 0.1 %: reduced 1e-3, also of a robot that moves, 4 µs "
        "a pose (in 95 of 100 set-ups)."
    )
    assert section.advice(None, found) == ""


def test_run_time_against_error_follows_the_first_plot_of_a_report_once_measured(found: Results) -> None:
    before = report.make(found.folder).path.read_text()
    assert "Run time against error of all methods" not in before
    store.write_json(found.folder / measure.ANSWER, {"key": "", **document(found, **ERRORS)})
    index = report.make(found.folder).path.read_text()
    one_more = before.count(f'class="{PLOT}"') + 1
    assert index.count(f'class="{PLOT}"') == one_more and f'src="{SCRIPT}"' in index
    assert index.index(plots_of_errors.TITLE) < index.index("Run time against error of all methods")


def test_a_measurement_is_kept_until_the_set_ups_change(tmp_path: Path) -> None:
    store.write_json(tmp_path / measure.ANSWER, {"key": measure.key(["one", "two"])})
    assert measure.run(tmp_path, ["one", "two"], wanted=True) == []
    assert (tmp_path / measure.ANSWER).is_file()
    assert measure.run(tmp_path, ["one"], wanted=False) == []
    assert not (tmp_path / measure.ANSWER).exists()
