"""`--correction` on the command line and in Python."""

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import fringe
import pytest

Command = Callable[..., "subprocess.CompletedProcess[str]"]
NAMES = [entry["name"] for entry in fringe.corrections()]


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "scene.toml"
    path.write_text(
        '[[sensor]]\nname = "front"\n'
        "plates = [ { corner = [-0.05, -0.05, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] } ]\n"
        '[[object]]\nname = "target"\nshape = { type = "plate", size = [0.08, 0.1] }\n'
        "translation = [0.01, 0, 0.03]\nrotation = { axis = [0, 1, 0], degrees = 20 }\n"
    )
    return path


@pytest.mark.parametrize("name", NAMES)
def test_command_and_module_agree(fringe_command: Command, scene: Path, name: str) -> None:
    printed = json.loads(fringe_command("capacitance", scene, "--json", "--correction", name).stdout)
    answer = fringe.Scene.load(scene).capacitance(correction=name)
    assert printed["options"]["correction"] == answer["options"]["correction"] == name
    assert printed["sensors"][0]["total"] == pytest.approx(answer["sensors"][0]["total"], rel=1e-12)


def test_every_correction_changes_the_answer(scene: Path) -> None:
    totals = {fringe.Scene.load(scene).capacitance(correction=name)["sensors"][0]["total"] for name in NAMES}
    assert len(totals) == len(NAMES)


def test_recommended_is_the_mutual_of_the_reduced_method(scene: Path) -> None:
    loaded = fringe.Scene.load(scene)
    matrix = loaded.maxwell(method="reduced:1")["maxwell"]
    assert loaded.capacitance(correction="recommended")["sensors"][0]["total"] == pytest.approx(
        -matrix[0, 1], rel=1e-12
    )


def test_an_unknown_name_is_refused_with_the_choices(fringe_command: Command, scene: Path) -> None:
    answer = fringe_command("capacitance", scene, "--correction", "magic")
    assert answer.returncode == 2 and answer.stdout == ""
    assert all(name in answer.stderr for name in NAMES)
    with pytest.raises(fringe.InputError, match="formula"):
        fringe.Scene.load(scene).capacitance(correction="magic")


def test_corrections_that_failed_are_refused_with_the_choices(fringe_command: Command, scene: Path) -> None:
    assert NAMES == ["none", "formula", "recommended"]
    for name in ("constant", "arc", "kirchhoff", "palmer", "reciprocity", "two-sided-arc"):
        answer = fringe_command("capacitance", scene, "--correction", name)
        assert answer.returncode == 2 and answer.stdout == ""
        assert f"'{name}'" in answer.stderr and "none, formula or recommended" in answer.stderr


def test_options_that_would_change_nothing_are_refused(fringe_command: Command, scene: Path) -> None:
    for options in (("--faces", "facing"), ("--tolerance", "0.1"), ("--method", "boundary-elements")):
        answer = fringe_command("capacitance", scene, "--correction", "formula", *options)
        assert answer.returncode == 2 and "correction" in answer.stderr
