"""The model's answers for cases before machines: which it has, and what it gives as the change of a reading."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis.pipeline import model_stage
from analysis.results import store
from analysis.results.answers import ModelAnswer
from analysis.results.study_results import SCENE
from geometries.scene.scene import Scene
from geometries.scene.writer import canonical
from geometries.studies import families
from geometries.studies.machines import GUARD, MACHINES

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


@pytest.mark.parametrize("machine", MACHINES)
def test_its_change_is_that_of_the_target_whatever_stays(machine: str, tmp_path: Path) -> None:
    store.write_text(tmp_path / SCENE, canonical(box(machine=machine)))
    found = ModelAnswer.of({"key": "", **model_stage.answer(tmp_path / SCENE, ("exact", "split:2"))})
    for method, sensors in found.values.items():
        assert found.changes[method] == {
            "sensor": pytest.approx(sensors["sensor"].objects["target"], rel=1e-12)
        }


def test_it_says_of_a_floating_target_that_it_does_not_know_the_change(tmp_path: Path) -> None:
    store.write_text(tmp_path / SCENE, canonical(box(material="floating", machine=GUARD)))
    found = ModelAnswer.of({"key": "", **model_stage.answer(tmp_path / SCENE, ("exact", "split:2"))})
    assert found.changes == {"exact": {}, "split:2": {}}
    assert set(found.values["exact"]["sensor"].objects) == {"housing"}
