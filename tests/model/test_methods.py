"""The methods by their names, on the command line and in Python."""

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fringe
import pytest

Command = Callable[..., "subprocess.CompletedProcess[str]"]
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
