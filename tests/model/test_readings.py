"""Readings as Python and the command give them."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import pytest

import geometries
from analysis.pipeline import model_stage

SCENE = Path(geometries.__file__).parent / "scenes" / "guarded_sensor.toml"
COMMAND = Path(geometries.__file__).parents[1] / "build/bin/fringe"
PARTS = ("value", "background", "change")


def printed(*options: str) -> str:
    return subprocess.run(
        [COMMAND, "capacitance", SCENE, *options], capture_output=True, text=True, check=True
    ).stdout


@pytest.fixture(scope="module")
def readings() -> Any:
    return model_stage.model_module().Scene.load(SCENE).readings("boundary-elements", rtol=1e-2)


def test_the_change_is_the_value_less_the_background(readings: Any) -> None:
    assert list(readings) == ["guarded", "transmitted", "unguarded"]
    for reading in readings.values():
        assert reading.change == pytest.approx(reading.value - reading.background, rel=1e-12)
        assert reading.answered_by == "boundary-elements"


def test_the_error_of_the_change_is_less_than_those_of_its_parts(readings: Any) -> None:
    for reading in readings.values():
        assert set(reading.error) == set(PARTS)
        assert reading.error["change"] < reading.error["value"] + reading.error["background"]


def test_the_command_prints_the_same_readings(readings: Any) -> None:
    document = json.loads(printed("--method", "boundary-elements", "--rtol", "0.01", "--json"))
    for described in document["readings"]:
        reading = readings[described["name"]]
        assert [described[part] for part in PARTS] == [getattr(reading, part) for part in PARTS]
        assert described["error"] == reading.error
    bounded = {described["name"] for described in document["readings"] if "lower" in described}
    assert bounded == {"unguarded"}  # Only the reading that drives just what it senses is an energy.


def test_the_table_has_a_line_for_every_reading() -> None:
    table = printed("--method", "boundary-elements", "--rtol", "0.01").split("Readings, pF")[1]
    assert [line.split()[0] for line in table.splitlines()[1:]] == ["guarded", "unguarded", "transmitted"]


def test_long_names_and_large_errors_keep_the_tables_columns_apart(tmp_path: Path) -> None:
    text = (
        SCENE.read_text()
        .replace("housing", "housing of the whole machine")
        .replace("unguarded", "without the guard")
    )
    (tmp_path / "scene.toml").write_text(text.replace("[0, 0, -0.07]", "[0, 0, -0.0602]"))
    done = subprocess.run(
        [COMMAND, "capacitance", tmp_path / "scene.toml", "--method", "reduced", "--entries"],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 3  # the guard is 0.2 mm before the housing
    head, *rows = done.stdout.split("\n\n")[1].splitlines()
    assert head.split("  ")[-1] == "housing of the whole machine"
    for row in rows:
        assert len(row) <= len(head) and row.count(" ± ") == 3
    assert all(line.startswith("  without the guard  ") for line in done.stdout.splitlines()[-2:-1])


def test_info_lists_the_readings_and_what_objects_are_to_them() -> None:
    document = json.loads(
        subprocess.run([COMMAND, "info", SCENE, "--json"], capture_output=True, check=True).stdout
    )
    by_name = {
        kind: {described.pop("name"): described for described in listed}
        for kind, listed in document["roles"].items()
    }
    assert by_name == model_stage.model_module().Scene.load(SCENE).roles()
    table = subprocess.run([COMMAND, "info", SCENE], capture_output=True, text=True, check=True).stdout
    assert "reading guarded: senses front, drives front and guard, noise 1 fF, threshold 5 fF" in table
    assert "object guard, electrode" in table and "object hand, target, 100 pF to ground" in table


def test_the_model_knows_no_change_of_a_floating_target() -> None:
    for reading in model_stage.model_module().Scene.load(SCENE).readings("exact").values():
        assert reading.change is None


def test_without_readings_and_targets_the_model_has_the_total_as_the_change(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(
        '[[sensor]]\nname = "front"\n'
        "plates = [ { corner = [0, 0, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] } ]\n"
        '[[object]]\nname = "plate"\nshape = { type = "plate", size = [0.1, 0.1] }\ntranslation = [0.05, 0.05, 0.03]\n'
    )
    scene = model_stage.model_module().Scene.load(path)
    reading = scene.readings("exact")["front"]
    assert reading.change == scene.capacitance()["sensors"][0]["total"]
    assert reading.value is None and reading.background is None and reading.error["change"] is None


def test_an_error_that_a_method_cannot_tell_is_null(tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(
        """
[[sensor]]
name = "front"
plates = [ { corner = [-0.05, -0.04, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.08, 0] } ]
[[object]]
name = "wall"
shape = { type = "plate", size = [10, 10] }
translation = [0, 0, 0.06]
target = true
"""
    )
    command = [COMMAND, "capacitance", scene, "--method", "formula"]
    done = subprocess.run([*command, "--json"], capture_output=True, text=True, check=True)
    document = json.loads(done.stdout)
    (reading,) = document["readings"]
    assert reading["change"] > 0 and reading["error"]["change"] is None
    printed_table = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    change = printed_table.split("Readings, pF")[1].split()[-1]
    assert float(change) > 0 and printed_table.rstrip().endswith(change)
    found = model_stage.model_module().Scene.load(scene).readings("formula")["front"]
    assert found.error["change"] is None
