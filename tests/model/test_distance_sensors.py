"""Distance sensors in the Python module `fringe`, `cone_closest`, `Scene.sense` and their errors, and what `fringe sense` prints."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import fringe
import numpy as np
import pytest

from tests import scenes

METHODS = ["field_of_view", "cone_equation"]
ORIGIN, UP = np.zeros(3), np.array([0.0, 0, 1])
ABOVE = np.array([[-3.0, -3, 2], [3, -3, 2], [0, 3, 2]])
"""A triangle 2 above the origin, beyond which the cone goes straight through."""

SCENE = (
    scenes.link("arm", translation=[0, 0, 0.5])
    + scenes.eye("eye", [0, 0, 0], [0, 0, -2], 60, 0.8, link="arm")
    + scenes.eye("back", [0, 0, 0], [0, 0, 1], 180, 0.8, link="arm")
    + scenes.body("floor", "plate", size=[2, 2])
    + scenes.body(
        "water", "cube", size=0.1, translation=[0.1, 0, 0.1], material={"relative_permittivity": 80}
    )
)


@pytest.mark.parametrize("method", METHODS)
def test_cone_closest_gives_distance_point_and_triangle(method: str) -> None:
    triangles = np.stack([ABOVE + UP, ABOVE])
    distance, point, triangle = fringe.cone_closest(triangles, ORIGIN, 7 * UP, np.pi / 2, 10, method)
    assert (distance, point.tolist(), triangle) == (2, [0, 0, 2], 1)


@pytest.mark.parametrize("method", METHODS)
def test_cone_closest_is_none_when_nothing_is_in_the_cone(method: str) -> None:
    assert fringe.cone_closest([ABOVE], ORIGIN, -UP, np.pi, 10, method) is None
    assert fringe.cone_closest([ABOVE], ORIGIN, UP, np.pi, 1.999, method) is None
    assert fringe.cone_closest(np.empty((0, 3, 3)), ORIGIN, UP, np.pi, 10, method) is None


@pytest.mark.parametrize(
    "wrong",
    [
        {"triangles": ABOVE},
        {"triangles": np.full((1, 3, 3), np.nan)},
        {"triangles": np.full((1, 3, 3), np.inf)},
        {"apex": [0, 0]},
        {"apex": [0, np.nan, 0]},
        {"direction": [0, 0, 0]},
        {"direction": [0, 0, np.inf]},
        {"full_angle": 0},
        {"full_angle": -1},
        {"full_angle": 3.2},
        {"full_angle": np.nan},
        {"range": 0},
        {"range": -1},
        {"range": np.inf},
        {"method": "field of view"},
    ],
    ids=str,
)
def test_cone_closest_refuses_wrong_input(wrong: dict[str, object]) -> None:
    right = {"triangles": [ABOVE], "apex": ORIGIN, "direction": UP, "full_angle": 1, "range": 1}
    with pytest.raises(ValueError):
        fringe.cone_closest(**{**right, **wrong})


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "a scene.toml"
    path.write_text(SCENE)
    return path


@pytest.fixture
def scene(path: Path) -> fringe.Scene:
    return fringe.Scene.load(path)


@pytest.mark.parametrize("method", METHODS)
def test_sense_names_what_every_sensor_sees(scene: fringe.Scene, method: str) -> None:
    eye, back = scene.sense(method)["distance_sensors"]
    # The cube's top, 0.15 high, begins 5 cm beside the axis.
    assert (eye["name"], eye["object"]) == ("eye", "water")
    assert eye["distance"] == pytest.approx(np.hypot(0.05, 0.35), rel=1e-14)
    assert eye["point"] == pytest.approx([0.05, 0, 0.15], abs=1e-15)
    triangle = scene.conductors()["water"][eye["triangle"]]
    assert triangle[:, 2] == pytest.approx(np.full(3, 0.15), abs=1e-15)
    assert back == {"name": "back", "distance": None, "point": None, "object": None, "triangle": None}


def test_sense_follows_the_links_and_agrees_with_cone_closest(scene: fringe.Scene) -> None:
    for height in (0.3, 0.7, 0.9, 2.0):
        scene.set_pose("arm", [0.3, 0.2, height], [1, 0, 0, 0])
        eye = scene.sense()["distance_sensors"][0]
        found = {
            name: fringe.cone_closest(triangles, [0.3, 0.2, height], -UP, np.radians(60), 0.8)
            for name, triangles in scene.conductors().items()
        }
        seen = {name: answer for name, answer in found.items() if answer is not None}
        if not seen:
            assert eye["distance"] is None
            continue
        nearest = min(seen, key=lambda name: float(seen[name][0]))
        assert eye["object"] == nearest
        assert eye["distance"] == pytest.approx(seen[nearest][0], rel=1e-14)
    assert scene.sense()["distance_sensors"][0]["distance"] is None  # from 2 m all is out of range


Command = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.mark.parametrize("method", METHODS)
def test_sense_as_table(fringe_command: Command, path: Path, method: str) -> None:
    done = fringe_command("sense", path, "--method", method)
    assert (done.returncode, done.stderr) == (0, "")
    _, _, eye, back = done.stdout.splitlines()
    assert eye.split()[:4] == ["eye", "353.553", "mm", "water,"]
    assert back.split() == ["back", "sees", "nothing"]


def test_a_scene_without_distance_sensors_has_no_readings(fringe_command: Command, path: Path) -> None:
    path.write_text('[[object]]\nname = "floor"\nshape = { type = "plate", size = [2, 2] }\n')
    assert json.loads(fringe_command("sense", path, "--json").stdout) == {
        "format": 1,
        "distance_sensors": [],
        "remarks": [],
    }
    assert fringe_command("sense", path).stdout == "the scene has no distance sensors\n"


def test_unknown_method_and_missing_file(fringe_command: Command, path: Path, tmp_path: Path) -> None:
    for arguments, reason in [
        ((path, "--method", "echo"), 'unknown method "echo"'),
        ((tmp_path / "none.toml",), "the file does not exist"),
    ]:
        done = fringe_command("sense", *arguments)
        assert (done.returncode, done.stdout) == (2, "")
        assert reason in done.stderr
