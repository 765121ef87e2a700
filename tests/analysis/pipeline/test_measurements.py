"""Measurements of the model by itself: made alone and once, and kept whole under their key."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis.pipeline import measurement_stage, processes
from analysis.pipeline.measurement_stage import Measurement
from analysis.results import machine, store
from analysis.results.study_results import Failure
from analysis.study import workflow
from geometries.studies import study


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
