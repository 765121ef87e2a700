"""The model's answers for cases before machines: which it has, and what it gives as the change of a reading. Measurements of the model by
itself: made alone and once, and kept whole under their key."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from analysis.pipeline import measurement_stage, model_stage, stage
from analysis.pipeline.measurement_stage import Measurement
from analysis.results import machine, store
from analysis.results.answers import ModelAnswer
from analysis.results.study_results import SCENE, Failure
from analysis.study import workflow
from geometries.common.errors import InputError
from geometries.scene.poses import Pose
from geometries.scene.scene import Scene
from geometries.scene.writer import canonical
from geometries.studies import families, study
from geometries.studies.machines import GUARD, MACHINES
from tests.analysis.synthetic import HEAD, PARALLEL
from tests.geometries import schemas

SENSOR = (0.1, 0.1)


def box(**more: float | str) -> Scene:
    return families.box(SENSOR, SENSOR, 0.03, 0.04, **more)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("scene", "expected"),
    [
        (box(), True),
        (box(machine=GUARD), True),
        (box(material="floating"), False),
        (box(material="floating", to_ground=1e-10, machine=GUARD), True),
        (box(material="dielectric", relative_permittivity=3.0), False),
        (box(material="dielectric", relative_permittivity=3.0, machine=GUARD), False),
    ],
)
def test_the_model_knows_grounded_conductors_and_before_machines_which_changes_it_does_not_know(
    scene: Scene, expected: bool
) -> None:
    assert model_stage.knows(scene) == expected


def answered(folder: Path, scene: Scene, *methods: str) -> ModelAnswer:
    """What the model stage makes of a scene, as it is read again."""
    store.write_text(folder / SCENE, canonical(scene))
    return ModelAnswer.of({"key": "", **model_stage.answer(folder / SCENE, methods)})


@pytest.mark.parametrize("machine", MACHINES)
def test_its_change_is_that_of_the_target_whatever_stays(machine: str, tmp_path: Path) -> None:
    found = answered(tmp_path, box(machine=machine), "exact", "split:2")
    for method, sensors in found.values.items():
        changes = found.changes[method]
        assert set(changes) == set(sensors)
        for name, change in changes.items():
            assert change.value == pytest.approx(sensors[name].objects["target"], rel=1e-12)


def test_it_says_of_a_floating_target_that_it_does_not_know_the_change(tmp_path: Path) -> None:
    found = answered(tmp_path, box(material="floating", machine=GUARD), "exact", "split:2")
    assert found.changes == {"exact": {}, "split:2": {}}
    assert set(found.values["exact"]["sensor"].objects) == {"housing"}


EVERY = (
    *("exact", "split:0", "split:10", "gauss:1", "gauss:64", "exact+nearest", "split:2+facing"),
    *("gauss:3+nearest+facing", "formula", "reduced", "boundary-elements", "auto"),
)
"""Methods of every form that a study may name, with the ends of their numbers."""


@pytest.mark.parametrize(
    "method",
    [
        *("split:11", "gauss:0", "gauss:65", "facing", "bem", "none", ""),
        *("formula+facing", "exact+facing+nearest", "reduced+nearest", "exact+sum"),
    ],
)
def test_other_methods_are_refused_with_a_list_of_those_that_there_are(method: str) -> None:
    with pytest.raises(InputError, match="model.methods.*must be.*reduced.*auto.*, not"):
        study.loads(study_of(method))


def study_of(*methods: str) -> str:
    return HEAD.replace('["exact", "split:0", "split:4"]', json.dumps(["exact", *methods])) + PARALLEL


def test_methods_that_solve_for_delta_self_state_it_with_its_error_and_who_answered(tmp_path: Path) -> None:
    """Two plates of 10 cm at 4 cm: the sum over the objects is mutual, 3.1 pF, and not delta_self, 1.7 pF."""
    plates = families.parallel(SENSOR, SENSOR, 0.04)
    found = answered(tmp_path, plates, "exact", "auto", "boundary-elements", "formula")
    by = {method: sensors["sensor"] for method, sensors in found.values.items()}
    truth = by["boundary-elements"]
    assert truth.total < 0.6 * truth.objects["target"]
    assert by["auto"].answered_by in ("reduced", "boundary-elements")
    for name in ("auto", "boundary-elements"):
        error = by[name].total_error
        assert error is not None and abs(by[name].total - truth.total) <= error + (truth.total_error or 0)
        assert set(by[name].errors) == {"target"}
    for name in ("exact", "formula"):
        assert by[name].total == by[name].objects["target"] and by[name].total_error is None
        assert by[name].answered_by == name


def test_a_method_that_refuses_a_case_does_not_take_the_others_answers(tmp_path: Path) -> None:
    plates = families.parallel(SENSOR, SENSOR, 0.04)
    ground = replace(plates.objects[0], name="ground", pose=Pose())
    touching = replace(plates, objects=(*plates.objects, ground))
    found = answered(tmp_path, touching, "exact", "boundary-elements")
    assert set(found.values) == {"exact"} and "touch or cross" in found.refused["boundary-elements"]
    assert str(tmp_path) not in found.refused["boundary-elements"]


def test_the_model_has_every_method_of_a_study_and_its_answers_and_refusals_are_what_the_schema_says(
    tmp_path: Path,
) -> None:
    assert study.loads(study_of(*EVERY[1:])).methods == EVERY
    plates = families.parallel(SENSOR, SENSOR, 0.1)
    ground = replace(plates.objects[0], name="ground", pose=Pose())
    for name, objects in (("apart", plates.objects), ("touching", (*plates.objects, ground))):
        store.write_text(tmp_path / name / SCENE, canonical(replace(plates, objects=objects)))
        document = model_stage.answer(tmp_path / name / SCENE, EVERY)
        refused = [method for method, answer in document["methods"].items() if "refused" in answer]
        assert bool(refused) == (name == "touching"), refused
        schemas.validator("model").validate(json.loads(json.dumps({"key": "k", **document})))


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
        return measurement_stage.stage(self.measurements[0], self.results).run(stage.Processes())

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


@pytest.mark.parametrize(("end", "passed"), [("true", True), ("false", False)])
def test_an_answer_is_stored_with_its_origin_and_whether_the_program_is_content(
    workshop: Workshop, end: str, passed: bool
) -> None:
    workshop.program("speed", f'echo \'{{"value": 1}}\' > "$2"; {end}')
    assert workshop.measure() is None
    stage = measurement_stage.stage(workshop.measurements[0], workshop.results)
    document = store.read_current(stage.target, stage.key)
    assert document is not None
    assert document["answer"] == {"value": 1} and document["passed"] is passed
    assert document["command"] == "build/bin/speed --json ANSWER.json"
    assert document["processor"] == machine.description()["processor"]
    assert [path.name for path in workshop.results.iterdir()] == ["speed.json"]


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


def test_measurements_are_made_if_asked_one_after_the_other_and_once_for_a_version_of_the_model(
    workshop: Workshop,
) -> None:
    assert workshop.run(measure_model=False) == []
    assert workshop.run(measure_model=True) == ["speed starts", "speed ends", "errors starts", "errors ends"]
    assert workshop.run(measure_model=True) == [] and workshop.run(measure_model=False) == []
    assert (workshop.results / "speed.json").is_file()
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
