"""Measurements of the model by itself: made alone and once, kept whole under their key, and told in the report."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from analysis.pipeline import measurement_stage, processes
from analysis.pipeline.measurement_stage import Measurement
from analysis.report import run_times_section, stability_section
from analysis.results import machine, measurements, store, study_results as results
from analysis.results.measurements import MethodTime
from analysis.results.study_results import Failure
from analysis.study import report, workflow
from geometries.studies import study
from tests.analysis.synthetic import make_results, report_text

ORIGIN = {
    "key": "k",
    "processor": "a processor",
    "instruction_sets": "AVX2",
    "command": "build/bin/it",
    "passed": True,
}


def timed(name: str, family: int, nanoseconds: float, error: float, **more: Any) -> dict[str, Any]:
    """An entry of the benchmark's answer."""
    seconds = nanoseconds / 1e9
    entry = {"name": name, "family_index": family, "run_type": "iteration", "triangles": 2000.0}
    return entry | {"per_triangle": seconds, "error": error} | more


def run_times_document(*entries: dict[str, Any]) -> dict[str, Any]:
    return ORIGIN | {"answer": {"context": {"compiler": "a compiler"}, "benchmarks": list(entries)}}


TIMES = run_times_document(
    timed("I_fine/exact", 0, 50, 4e-16),
    timed("I_fine/split:4", 1, 800, 3e-7),
    timed("I_fine/split:0", 2, 30, 8e-5),
    timed("II_fine/exact", 3, 200, 5e-16),
    timed("II_fine/split:4", 4, 700, 4e-7),
    timed("II_fine/split:0", 5, 250, 8e-5),
)


def errors_document(**more: Any) -> dict[str, Any]:
    errors = {
        "triangles": 100,
        "not_finite": 0,
        "wrong_by_1_percent": 0,
        "largest_error": 1e-15,
        "median_error": 1e-16,
        "largest_over_conditioning": 4.0,
        "median_over_conditioning": 0.5,
        "percentile_99_over_conditioning": 3.0,
    }
    return errors | more


def stability_document(exact: dict[str, Any] | None = None, **more: Any) -> dict[str, Any]:
    """Two classes: in the second the thesis' formula gives no number for 7 of its 40 triangles."""
    nothing = errors_document(
        triangles=0, largest_over_conditioning=None, percentile_99_over_conditioning=None
    )
    thesis = errors_document(triangles=40, not_finite=7, wrong_by_1_percent=9, largest_over_conditioning=2e6)
    classes = [
        {"name": "random", "truth_failed": 0, "methods": {"exact": errors_document(), "thesis": nothing}},
        {
            "name": "parallel",
            "truth_failed": 0,
            "methods": {"thesis": thesis, "exact": exact or errors_document()},
        },
    ]
    return ORIGIN | {"answer": {"limit": 16.0, "classes": classes}} | more


def stability(document: dict[str, Any]) -> measurements.Stability:
    found = measurements.stability(document)
    assert found is not None
    return found


def run_times(document: dict[str, Any]) -> measurements.RunTimes:
    found = measurements.run_times(document)
    assert found is not None
    return found


def test_of_repetitions_in_any_order_the_fastest_counts_and_aggregates_do_not() -> None:
    found = run_times(
        run_times_document(
            timed("b/exact", 1, 90, 2e-16),
            timed("a/split:4", 0, 30, 1e-7),
            timed("b/exact", 1, 80, 2e-16),
            timed("b/exact", 1, 1, 2e-16, run_type="aggregate"),
            timed("a/split:4", 0, 40, 1e-7),
        )
    )
    assert found.times == (
        MethodTime("a", "split:4", 30 / 1e9, 1e-7, 2000),
        MethodTime("b", "exact", 80 / 1e9, 2e-16, 2000),
    )


def test_the_front_is_what_nothing_else_beats_in_both() -> None:
    def time(method: str, seconds: float, error: float) -> MethodTime:
        return MethodTime("set", method, seconds, error, 1)

    times = [
        time("exact", 5, 1),
        time("as slow as exact and worse", 5, 2),
        time("fast", 1, 9),
        time("beaten", 4, 6),
        time("between", 3, 5),
        time("as wrong as fast and slower", 2, 9),
    ]
    assert [t.method for t in run_times_section.front(times)] == ["fast", "between", "exact"]


def test_the_finding_on_run_times_computed_by_hand() -> None:
    text = run_times_section.finding(run_times_section.by_set(run_times(TIMES)))
    assert "exact is right to 5.0e-16 on every set" in text
    assert "split:4 takes from 3.5 to 16 times as long and is wrong by 3e-07 to 4e-07" in text
    assert text.endswith("are exact, split:0.")


def test_front_entries_are_bold_in_the_table() -> None:
    text = run_times_section.section(run_times(TIMES))
    bold = re.findall(r"<strong>([\d.,]+)<br>", text)
    assert sorted(bold) == ["200", "30", "50"]
    for told in ("800<br>3e-07", "a compiler", "a processor", "build/bin/it"):
        assert told in text


def test_the_finding_on_stability_computed_by_hand() -> None:
    text = stability_section.finding(stability(stability_document()))
    assert "exact keeps the limit of 16 in all 2 classes" in text
    assert "Over 200 triangles exact is off by up to 4 times the conditioning" in text
    assert "Over 40 triangles the thesis' formula is off by up to 2e+06 times" in text
    assert "7 of its values are not finite, 9 are wrong by more than 1 %" in text


@pytest.mark.parametrize(
    "more",
    [{"largest_over_conditioning": 16.1}, {"not_finite": 1}, {"wrong_by_1_percent": 1}],
)
def test_a_class_in_which_the_exact_method_fails_is_named(more: dict[str, Any]) -> None:
    text = stability_section.finding(stability(stability_document(errors_document(**more))))
    assert "exact fails, in: parallel." in text and "keeps" not in text


def test_what_the_program_found_wrong_is_never_told_as_right() -> None:
    assert "exact fails." in stability_section.finding(stability(stability_document(passed=False)))


def test_a_class_without_finite_values_has_counts_and_no_error() -> None:
    exact = errors_document(largest_over_conditioning=None, percentile_99_over_conditioning=None)
    text = stability_section.section(stability(stability_document(exact)))
    (row,) = re.findall(r"<tr><td class=\"text\">parallel</td>(.*?)</tr>", text)
    cells = re.findall(r"<td *>(.*?)</td>", row)
    assert cells == ["100", "", "0", "0", "2e+06", "7 of 40", "9 of 40"]


def section_of(page: str, title: str) -> str:
    (found,) = re.findall(rf"<section>\s*<h2>{re.escape(title)}</h2>(.*?)</section>", page, re.DOTALL)
    return str(found)


@pytest.mark.parametrize("title", [run_times_section.TITLE, stability_section.TITLE])
def test_results_without_a_measurement_say_so_and_how_to_make_it(tmp_path: Path, title: str) -> None:
    text = section_of(report_text(make_results(tmp_path)), title)
    assert "These results have no measurement" in text and "--measure-model" in text
    assert "plotly" not in text


def test_the_report_takes_measurements_up_when_they_appear(tmp_path: Path) -> None:
    folder = make_results(tmp_path)
    report.make(folder)
    store.write_json(folder / results.RUN_TIMES, TIMES)
    store.write_json(folder / results.STABILITY, stability_document())
    text = report_text(folder)
    assert section_of(text, run_times_section.TITLE).count("plotly-graph-div") == 2
    assert section_of(text, stability_section.TITLE).count("plotly-graph-div") == 1


class Workshop:
    """A repository with two programs that measure, and a results folder."""

    def __init__(self, folder: Path) -> None:
        self.repository = folder / "with space"
        self.results = folder / "results"
        self.log = folder / "log"
        self.measurements = (self._measurement("speed", 2), self._measurement("errors", 1))
        for measurement in self.measurements:
            self.program(measurement.program, 'sleep 0.2; echo \'{"value": 1}\' > "$2"')
        store.write_text(self.repository / "model" / "a.cpp", "first")

    def _measurement(self, name: str, seconds: float) -> Measurement:
        return Measurement(name, f"{name}.json", name, ("--json", "ANSWER.json"), seconds, ("model",))

    def program(self, name: str, text: str) -> None:
        path = self.repository / "build" / "bin" / name
        log = f'echo "{name} starts" >> "{self.log}"\n', f'echo "{name} ends" >> "{self.log}"\n'
        store.write_text(path, f"#!/bin/sh\n{log[0]}{{ {text}\n}}\ncode=$?\n{log[1]}exit $code\n")
        path.chmod(0o755)

    def measure(self) -> Failure | None:
        return measurement_stage.stage(self.measurements[0], self.results).run(processes.Processes())

    def stored(self) -> store.Document | None:
        """The answer that is stored under the key of today."""
        stage = measurement_stage.stage(self.measurements[0], self.results)
        return store.read_current(stage.target, stage.key)

    def key(self, number: int) -> str:
        return measurement_stage.stage(self.measurements[number], self.results).key

    def run(self, measure_model: bool) -> list[str]:
        """Bring a study without sweeps' answers up to date; returns what the programs logged meanwhile."""
        self.log.unlink(missing_ok=True)
        nothing = study.Study("n", "t", 1e-3, 60.0, "estimate", ("exact",), ())
        assert not workflow.run(nothing, self.results, 2, measure_model)
        return self.log.read_text().splitlines() if self.log.is_file() else []


@pytest.fixture
def workshop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Workshop:
    made = Workshop(tmp_path)
    monkeypatch.setattr(measurement_stage, "ROOT", made.repository)
    monkeypatch.setattr(measurement_stage, "MEASUREMENTS", made.measurements)
    return made


def test_an_answer_is_stored_with_key_and_origin(workshop: Workshop) -> None:
    assert workshop.measure() is None
    document = workshop.stored()
    assert document is not None
    assert document["answer"] == {"value": 1} and document["passed"] is True
    assert document["command"] == "build/bin/speed --json ANSWER.json"
    assert document["processor"] == machine.description()["processor"]
    assert [path.name for path in workshop.results.iterdir()] == ["speed.json"]


def test_a_program_that_is_not_content_gives_an_answer_that_says_so(workshop: Workshop) -> None:
    workshop.program("speed", "echo '{}' > \"$2\"; false")
    assert workshop.measure() is None
    document = workshop.stored()
    assert document is not None and document["passed"] is False


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("echo '{}' > \"$2\"; echo first >&2; echo no memory >&2; exit 2", "exit code 2: no memory"),
        ("false", "exit code 1: no message"),
        ("true", "exit code 0: no message"),
        ("echo '{' > \"$2\"", "wrote no JSON document"),
    ],
)
def test_without_an_answer_nothing_is_stored_and_the_reason_told(
    workshop: Workshop, text: str, reason: str
) -> None:
    workshop.program("speed", text)
    failure = workshop.measure()
    assert failure is not None and failure.stage == "speed" and reason in failure.reason
    assert not list(workshop.results.iterdir())


def test_a_program_that_is_not_built_is_named(workshop: Workshop) -> None:
    (workshop.repository / "build" / "bin" / "speed").unlink()
    failure = workshop.measure()
    assert failure is not None and failure.reason == "build/bin/speed is missing: ./run builds it"


def test_measurements_are_made_one_after_the_other_and_once(workshop: Workshop) -> None:
    assert workshop.run(measure_model=True) == ["speed starts", "speed ends", "errors starts", "errors ends"]
    assert workshop.run(measure_model=True) == []


def test_without_being_asked_nothing_is_measured_and_what_is_current_stays(workshop: Workshop) -> None:
    assert workshop.run(measure_model=False) == []
    workshop.run(measure_model=True)
    workshop.run(measure_model=False)
    assert (workshop.results / "speed.json").is_file()


def test_a_changed_model_makes_measurements_void(workshop: Workshop) -> None:
    workshop.run(measure_model=True)
    store.write_text(workshop.repository / "model" / "a.cpp", "second")
    workshop.run(measure_model=False)
    assert not (workshop.results / "speed.json").is_file()


def test_another_machine_makes_measurements_void(workshop: Workshop, monkeypatch: pytest.MonkeyPatch) -> None:
    workshop.run(measure_model=True)
    monkeypatch.setattr(machine, "identity", lambda: {"name": "another"})
    assert len(workshop.run(measure_model=True)) == 4


def test_the_key_knows_sources_arguments_and_machine(
    workshop: Workshop, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = workshop.key(0)
    assert here == workshop.key(0) != workshop.key(1)
    store.write_text(workshop.repository / "model" / "notes.md", "no source")
    assert here == workshop.key(0)
    store.write_text(workshop.repository / "model" / "b.hpp", "a source")
    changed = workshop.key(0)
    assert changed != here
    monkeypatch.setattr(machine, "identity", lambda: {"name": "another"})
    assert workshop.key(0) != changed


def test_this_machine_is_described_in_words() -> None:
    told = machine.description()
    assert int(told["cores"]) >= 1 and told["processor"]
    assert machine.instruction_sets()
    assert "flags" in machine.identity()
