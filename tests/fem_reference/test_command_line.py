"""python3 -m fem_reference: exit statuses, messages, and what is left behind."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
SCENE = """
[[sensor]]
name = "front"
plates = [ { corner = [-0.05, -0.05, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] } ]

[[object]]
name = "target"
shape = { type = "plate", size = [0.06, 0.06] }
translation = [0.01, 0, 0.03]
"""


def command(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    words = [sys.executable, "-m", "fem_reference", *map(str, arguments)]
    return subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "a scene.toml"
    path.write_text(SCENE)
    return path


def test_json_is_one_document_with_the_whole_answer(scene: Path) -> None:
    done = command(scene, "--json")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["conductors"] == ["front", "target"] and found["reached"] and found["rtol"] == 1e-3
    maxwell, error = np.array(found["maxwell"]), np.array(found["error"])
    np.testing.assert_allclose(np.array(found["upper"]) - found["lower"], 2 * error, rtol=1e-9)
    assert np.all(error <= 1e-3 * np.abs(maxwell))
    assert len(found["levels"]) >= 3 and found["unknowns"] == found["levels"][-1]["unknowns"]
    change = found["delta_self"]["front"]
    assert 0 < change["value"] < maxwell[0, 0] and change["error"] <= 1e-3 * change["value"]


def test_when_time_is_short_the_answer_admits_it(scene: Path) -> None:
    """One level says nothing about its own error: 100 %, and exit status 3."""
    done = command(scene, "--json", "--max-seconds", "0.1")
    assert done.returncode == 3
    found = json.loads(done.stdout)
    assert not found["reached"] and len(found["levels"]) == 1
    assert np.all(np.array(found["error"]) >= np.abs(found["maxwell"]))
    assert "asked 0.001, reached" in done.stderr


def test_people_get_a_table_with_errors_and_a_line_per_level(scene: Path) -> None:
    done = command(scene, "--max-seconds", "0.1")
    assert "delta_self, pF" in done.stdout and "±" in done.stdout
    assert done.stderr.startswith("edge size")


@pytest.mark.parametrize(
    "change, words",
    [
        (("size = [0.06, 0.06]", "size = [0.06, 0]"), "shape.size"),
        (("size = [0.06, 0.06]", "size = [0.06, nan]"), "shape.size"),
        (("size = [0.06, 0.06]", "sizes = [0.06, 0.06]"), "sizes"),
        (('type = "plate"', 'type = "blob"'), "blob"),
        (("translation = [0.01, 0, 0.03]", "translation = [0.01, 0, 0]"), "touch or cross"),
        (("translation", "translatoin"), "translatoin"),
    ],
)
def test_wrong_input_is_named_and_leaves_nothing(scene: Path, change: tuple[str, str], words: str) -> None:
    scene.write_text(SCENE.replace(*change))
    done = command(scene, "--json")
    assert done.returncode == 2 and done.stdout == ""
    assert str(scene) in done.stderr and words in done.stderr
    assert "Traceback" not in done.stderr
    assert list(scene.parent.iterdir()) == [scene]


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    done = command(tmp_path / "nowhere.toml")
    assert done.returncode == 2 and "nowhere.toml" in done.stderr and done.stdout == ""


@pytest.mark.parametrize(
    "arguments", [["--rtol", "0"], ["--rtol", "nan"], ["--max-seconds", "-1"], ["--wrong"]]
)
def test_wrong_options_are_refused(scene: Path, arguments: list[str]) -> None:
    done = command(scene, *arguments)
    assert done.returncode == 2 and arguments[-1] in done.stderr and done.stdout == ""


def test_a_slice_of_the_potential_runs_from_the_sensor_to_the_ground(scene: Path, tmp_path: Path) -> None:
    done = command(scene, "--slice", tmp_path / "slice.json")
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "slice.json").read_text())
    potential = np.array(found["potential"])
    along, z = np.array(found["along"]), np.array(found["z"])
    assert potential.shape == (len(z), len(along))
    assert found["origin"] == pytest.approx([0.005, 0]) and found["direction"] == [1, 0]
    assert -0.01 < potential.min() < 0.3 and 0.9 < potential.max() < 1.01
    near_target = potential[np.abs(z - 0.03).argmin(), np.abs(along - 0.005).argmin()]
    near_sensor = potential[np.abs(z).argmin(), np.abs(along - 0.005).argmin()]
    assert near_target < 0.1 and near_sensor > 0.9


def test_a_slice_that_cannot_be_written_leaves_nothing(scene: Path, tmp_path: Path) -> None:
    done = command(scene, "--slice", tmp_path / "missing" / "slice.json")
    assert done.returncode == 1 and "missing" in done.stderr
    assert list(tmp_path.iterdir()) == [scene]


def test_help_names_every_exit_status() -> None:
    done = command("--help")
    assert done.returncode == 0 and "Exit status: 0 answered; 2 wrong input; 3" in done.stdout
