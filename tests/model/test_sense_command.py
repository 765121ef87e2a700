"""What `fringe sense` prints, and with which exit code."""

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

Command = Callable[..., "subprocess.CompletedProcess[str]"]

SCENE = """
[[distance_sensor]]
name = "eye"
apex = [0, 0, 0.5]
direction = [0, 0, -1]
full_angle_degrees = 60
range = 0.8

[[distance_sensor]]
name = "back"
apex = [0, 0, 0.5]
direction = [0, 0, 1]
full_angle_degrees = 180
range = 0.8

[[object]]
name = "floor"
shape = { type = "plate", size = [2, 2] }
"""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "a scene.toml"
    path.write_text(SCENE)
    return path


@pytest.mark.parametrize("method", ["field_of_view", "cone_equation"])
def test_sense_as_json(fringe_command: Command, scene: Path, method: str) -> None:
    done = fringe_command("sense", scene, "--json", "--method", method)
    assert (done.returncode, done.stderr) == (0, "")
    eye, back = json.loads(done.stdout)["distance_sensors"]
    assert eye.pop("point") == pytest.approx([0, 0, 0], abs=1e-16)
    # The axis meets the floor on the line between its two triangles.
    assert eye == {"name": "eye", "distance": 0.5, "object": "floor", "triangle": 0}
    assert back == {"name": "back", "distance": None, "point": None, "object": None, "triangle": None}


def test_sense_as_table(fringe_command: Command, scene: Path) -> None:
    done = fringe_command("sense", scene)
    assert (done.returncode, done.stderr) == (0, "")
    _, _, eye, back = done.stdout.splitlines()
    assert eye.split()[:4] == ["eye", "500", "mm", "floor,"]
    assert back.split() == ["back", "sees", "nothing"]


def test_a_scene_without_distance_sensors_has_no_readings(fringe_command: Command, scene: Path) -> None:
    scene.write_text('[[object]]\nname = "floor"\nshape = { type = "plate", size = [2, 2] }\n')
    assert json.loads(fringe_command("sense", scene, "--json").stdout) == {
        "format": 1,
        "distance_sensors": [],
        "remarks": [],
    }
    assert fringe_command("sense", scene).stdout == "the scene has no distance sensors\n"


def test_unknown_method_and_missing_file(fringe_command: Command, scene: Path, tmp_path: Path) -> None:
    for arguments, reason in [
        ((scene, "--method", "echo"), 'unknown method "echo"'),
        ((tmp_path / "none.toml",), "the file does not exist"),
    ]:
        done = fringe_command("sense", *arguments)
        assert (done.returncode, done.stdout) == (2, "")
        assert reason in done.stderr
