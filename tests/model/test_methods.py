"""The methods by their names, on the command line and in Python."""

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fringe
import pytest

Command = Callable[..., "subprocess.CompletedProcess[str]"]
MODEL = ("exact", "split:2", "gauss:3", "exact+nearest", "exact+facing", "exact+nearest+facing")
STATING = ("reduced", "boundary-elements", "auto")


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


def total(answer: dict[str, Any]) -> float:
    return float(answer["sensors"][0]["total"])


@pytest.mark.parametrize("method", [*MODEL, "formula", *STATING])
def test_command_and_module_agree(fringe_command: Command, scene: Path, method: str) -> None:
    printed = json.loads(fringe_command("capacitance", scene, "--json", "--method", method).stdout)
    answer = fringe.Scene.load(scene).capacitance(method)
    assert printed["options"] == answer["options"] and answer["options"]["method"] == method
    assert printed["answered_by"] == answer["answered_by"]
    assert answer["answered_by"] == method or (method == "auto" and answer["answered_by"] in STATING)
    assert total(printed) == pytest.approx(total(answer), rel=1e-12)


def test_the_formula_is_nearer_to_the_truth_than_the_model_and_the_others_are_right(scene: Path) -> None:
    loaded = fringe.Scene.load(scene)
    truth = -loaded.maxwell(rtol=1e-4)["maxwell"][0, 1]
    by = {method: total(loaded.capacitance(method)) / truth - 1 for method in ("exact", "formula")}
    assert abs(by["formula"]) < 0.05 < abs(by["exact"])
    for method in STATING:
        for rtol in (1e-2, 1e-3):
            assert total(loaded.capacitance(method, rtol=rtol, entries=True)) == pytest.approx(
                truth, rel=rtol
            )


def test_auto_is_asked_where_an_accuracy_is_and_else_the_model(fringe_command: Command, scene: Path) -> None:
    for options, method in (((), "exact"), (("--rtol", "0.05"), "auto")):
        document = json.loads(fringe_command("capacitance", scene, "--json", *options).stdout)
        assert document["options"]["method"] == method
    loaded = fringe.Scene.load(scene)
    assert loaded.capacitance()["options"]["method"] == "exact"
    assert loaded.capacitance(rtol=0.05)["options"] == {"method": "auto", "rtol": 0.05}
    (reading,) = loaded.readings().values()
    assert reading.answered_by in ("formula", *STATING)
    assert reading.error["change"] <= 1e-2 * reading.change


def test_an_unknown_name_is_refused_with_the_choices(fringe_command: Command, scene: Path) -> None:
    answer = fringe_command("capacitance", scene, "--method", "magic")
    assert answer.returncode == 2 and answer.stdout == ""
    assert all(name in answer.stderr for name in ("split:N", "gauss:K", "formula", *STATING))
    with pytest.raises(fringe.InputError, match="formula"):
        fringe.Scene.load(scene).capacitance("magic")
    with pytest.raises(TypeError, match='no keyword "magic"'):
        fringe.Scene.load(scene).capacitance(magic=1)


def test_options_that_would_change_nothing_are_refused(fringe_command: Command, scene: Path) -> None:
    for method, options in (
        ("formula+facing", ()),
        ("formula", ("--tolerance", "0.1")),
        ("formula", ("--prepared", "folder")),
        ("exact", ("--max-seconds", "1")),
        ("split:2", ("--derivatives",)),
    ):
        answer = fringe_command("capacitance", scene, "--method", method, *options)
        assert answer.returncode == 2 and answer.stdout == "" and answer.stderr.count("\n") == 1
