"""The reduced method from outside: known set-ups, the command, the Python module and its prepared bodies."""

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.model.test_boundary_elements import SCENE, SET_UPS, scene_of

fringe = pytest.importorskip("fringe")

Command = Callable[..., "subprocess.CompletedProcess[str]"]

RTOLS = (1e-2, 1e-3, 3e-4)


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    return path


@pytest.mark.parametrize("case", SET_UPS, ids=lambda case: case["name"])
def test_plates_against_another_boundary_element_method(case: dict[str, Any], tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(scene_of(case))
    truth = 1e-12 * np.array(case["maxwell_pF"])
    unsure = case["relative_error"] * np.abs(truth)
    for rtol in RTOLS:
        answer = fringe.Scene.load(path).maxwell(method="reduced", rtol=rtol)
        difference = np.abs(answer["maxwell"] - truth)
        assert answer["rtol"] == rtol
        assert np.all(difference <= answer["error"] + unsure)
        if answer["reached"]:
            assert np.all(difference <= rtol * np.abs(truth) + unsure)


def test_the_module_answers_like_the_command(fringe_command: Command, scene: Path) -> None:
    done = fringe_command(
        "capacitance", scene, "--method", "reduced", "--rtol", "0.02", "--entries", "--json"
    )
    assert (done.returncode, done.stderr) == (0, "")
    answer = json.loads(done.stdout)
    assert answer["options"] == {"method": "reduced", "rtol": 0.02, "entries": True}
    assert answer["conductors"] == ["front", "palm"] and answer["floating"] == ["foil"]
    assert answer["lower_bounds"] == [False, False]
    (sensor,) = answer["sensors"]
    (palm,) = sensor["objects"]
    assert palm["capacitance"] == -answer["maxwell"][0][1] and palm["error"] == answer["error"][0][1]
    assert sensor["self"] == answer["maxwell"][0][0] and 0 < sensor["delta_self"] < sensor["self"]
    assert np.array_equal(
        fringe.Scene.load(scene).maxwell(method="reduced", rtol=0.02)["maxwell"], answer["maxwell"]
    )


def test_rtol_may_be_asked_for(scene: Path) -> None:
    loaded = fringe.Scene.load(scene)
    loose, strict = (loaded.maxwell(method="reduced", rtol=rtol) for rtol in (0.1, 5e-4))
    assert strict["rtol"] == 5e-4 and np.max(strict["error"] / np.abs(strict["maxwell"])) <= 5e-4
    assert loose["unknowns"] < strict["unknowns"] or np.all(loose["error"] > strict["error"])


def test_what_is_prepared_serves_every_pose(scene: Path) -> None:
    moving = fringe.Scene.load(scene)
    moving.maxwell(method="reduced", rtol=1e-3)
    for height in (0.1, 0.02, 0.05):
        moving.set_pose("hand", [0, 0, height], [1, 0, 0, 0])
        fresh = fringe.Scene.load(scene)
        fresh.set_pose("hand", [0, 0, height], [1, 0, 0, 0])
        answer = moving.maxwell(method="reduced", rtol=1e-3)
        assert np.array_equal(answer["maxwell"], fresh.maxwell(method="reduced", rtol=1e-3)["maxwell"])
        truth = fresh.maxwell(rtol=1e-4)
        assert np.all(np.abs(answer["maxwell"] - truth["maxwell"]) <= answer["error"] + truth["error"])


def test_the_table_for_people(fringe_command: Command, scene: Path) -> None:
    done = fringe_command("capacitance", scene, "--method", "reduced", "--rtol", "2e-3", "--entries")
    assert done.returncode == 0
    for text in ("by reduced, pF", "±", "rtol 0.002 reached", "delta_self", "foil"):
        assert text in done.stdout
    assert "the truth" not in done.stdout


def test_the_module_refuses_as_the_command_does(scene: Path) -> None:
    with pytest.raises(fringe.InputError, match="rtol 1e-09 must be from 1e-06 to 0.5"):
        fringe.Scene.load(scene).maxwell(method="reduced", rtol=1e-9)
    with pytest.raises(fringe.InputError, match="exact finds no Maxwell matrix"):
        fringe.Scene.load(scene).maxwell(method="exact")


def test_a_ball_is_known_by_its_triangles(tmp_path: Path) -> None:
    path = tmp_path / "ball.toml"
    ball = '"sphere", radius = 0.02, segments = 12'
    path.write_text(SCENE.replace('"cuboid", size = [0.08, 0.1, 0.03]', ball))
    scene = fringe.Scene.load(path)
    answer, truth = scene.maxwell(method="reduced", rtol=0.1), scene.maxwell(rtol=5e-3)
    assert answer["reached"]
    assert np.all(np.abs(answer["maxwell"] - truth["maxwell"]) <= answer["error"] + truth["error"])


def test_too_many_triangles_are_refused_by_name(fringe_command: Command, tmp_path: Path) -> None:
    path = tmp_path / "ball.toml"
    ball = '"sphere", radius = 0.02, segments = 72'
    path.write_text(SCENE.replace('"cuboid", size = [0.08, 0.1, 0.03]', ball))
    done = fringe_command("capacitance", path, "--method", "reduced", "--entries")
    assert (done.returncode, done.stdout) == (2, "")
    assert f'{path}: object "palm" has 5040 triangles' in done.stderr


def test_near_contact_is_not_reached_status_3_and_answered(fringe_command: Command, tmp_path: Path) -> None:
    path = tmp_path / "narrow.toml"
    path.write_text(SCENE.replace("[0, 0, 0.05]", "[0, 0, 0.01501]"))
    done = fringe_command("capacitance", path, "--method", "reduced", "--rtol", "1e-3", "--entries", "--json")
    assert done.returncode == 3 and "was not reached" in done.stderr
    answer = json.loads(done.stdout)
    assert not answer["reached"] and answer["error"][0][0] > 1e-3 * answer["maxwell"][0][0]


def test_members_of_conductors_have_their_charges(fringe_command: Command, tmp_path: Path) -> None:
    path = tmp_path / "members.toml"
    box = '[[object]]\nname = "{}"\nshape = {{ type = "cube", size = 0.02 }}\ntranslation = {}\n'
    sensor = "plates = [ { corner = [-0.02, -0.02, 0], edge_u = [0.04, 0, 0], edge_v = [0, 0.04, 0] } ]"
    path.write_text(
        f'[[sensor]]\nname = "front"\n{sensor}\n'
        + box.format("low", [0, 0, 0.03])
        + box.format("high", [0, 0, 0.05])
        + box.format("left", [-0.1, 0, 0.03])
        + 'conductor = "pair"\n'
        + box.format("right", [0.1, 0, 0.03])
        + 'conductor = "pair"\n'
    )
    done = fringe_command("capacitance", path, "--method", "reduced", "--rtol", "0.05", "--entries", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    answer = json.loads(done.stdout)
    assert answer["conductors"] == ["front", "low", "pair"]
    assert answer["members"] == [["front"], ["low", "high"], ["left", "right"]]
    for row, charges in zip(answer["maxwell"], answer["charges"], strict=True):
        assert np.allclose(np.sum(charges, axis=0), row, rtol=1e-12, atol=0)
    low, high = np.array(answer["charges"][1])[:, 0]
    assert low < high < 0, "the lower cube is nearer to the sensor"
    left, right = np.array(answer["charges"][2])[:, 0]
    assert left == pytest.approx(right, rel=1e-3)

    matrix = fringe.Scene.load(path).maxwell(method="reduced", rtol=0.05)
    truth = fringe.Scene.load(path).maxwell(rtol=1e-2)
    assert matrix["members"] == truth["members"] == answer["members"]
    for charges, true_charges in zip(matrix["charges"], truth["charges"], strict=True):
        assert np.allclose(charges, true_charges, rtol=0.05, atol=0)
