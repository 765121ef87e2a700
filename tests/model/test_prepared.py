"""Data that take long to prepare are kept in a folder, and the time that they take is bounded: by the command and in Python."""

import re
from pathlib import Path

import fringe
import pytest

from tests import scenes
from tests.programs import fringe_command, shown_on_a_terminal


SCENE = (
    scenes.link("hand", translation=[0, 0, 0.1])
    + scenes.sensor("front", [[-0.03, -0.04, 0], [0.06, 0, 0], [0, 0.08, 0]])
    + scenes.body("housing", "cuboid", size=[0.2, 0.12, 0.05], translation=[0, 0, -0.03])
    + scenes.link("arm")
    + scenes.body(
        "arm, in contact with what does not move along",
        "cuboid",
        size=[0.05, 0.05, 0.1],
        link="arm",
        translation=[0.1, 0, -0.03],
    )
    + scenes.body("hand", "cuboid", size=[0.05, 0.09, 0.02], link="hand", target=True)
)
MOTION = scenes.table("frame", name="far") + scenes.table(
    "frame", name="near", poses=[{"link": "hand", "translation": [0, 0, 0.06]}]
)


def names(folder: Path) -> list[str]:
    """The kinds of the files in a folder."""
    return sorted(file.name.rpartition("-")[0] for file in folder.iterdir())


def test_the_command_finds_what_it_has_prepared(scene: Path, tmp_path: Path) -> None:
    words = ("capacitance", scene, "--method", "reduced", "--rtol", "0.2")
    folder = tmp_path / "a" / "folder"
    first = fringe_command(*words, "--prepared", folder)
    times = {file: file.stat().st_mtime_ns for file in folder.iterdir()}
    second = fringe_command(*words, "--prepared", folder)
    assert names(folder) == ["link", "tables", "targets"]
    assert {file: file.stat().st_mtime_ns for file in folder.iterdir()} == times
    readings = [done.stdout.partition("Readings")[2] for done in (first, second)]
    assert readings[0] and readings[0] == readings[1]
    # Python reads the same files.
    kept = fringe.Scene.load(scene).readings("reduced", rtol=0.2, prepared=folder)["front"]
    known = fringe.Scene.load(scene).readings("reduced", rtol=0.2)["front"]
    assert (kept.change, kept.error) == (known.change, known.error)
    assert {file: file.stat().st_mtime_ns for file in folder.iterdir()} == times


def test_a_sweep_gives_the_folder_to_the_methods_that_have_it(scene: Path, tmp_path: Path) -> None:
    words = ("sweep", scene, "--rtol", "0.2", "--method")
    done = fringe_command(*words, "reduced", "--prepared", tmp_path / "folder")
    assert done.returncode in (0, 3) and done.stdout
    assert set(names(tmp_path / "folder")) == {"link", "tables", "targets"}
    assert fringe_command(*words, "exact,auto", "--prepared", tmp_path / "folder").returncode == 0
    refused = fringe_command("sweep", scene, "--method", "exact", "--prepared", tmp_path / "other")
    assert refused.returncode == 2 and "prepared is no option of exact" in refused.stderr
    assert not (tmp_path / "other").exists()


def test_a_folder_that_cannot_be_is_refused(scene: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    done = fringe_command(
        "capacitance", scene, "--method", "reduced", "--rtol", "0.2", "--prepared", tmp_path / "file"
    )
    told = f"prepared: {tmp_path / 'file'} is no folder that can be written"
    assert done.returncode == 2 and done.stderr == f"fringe: {scene}: {told}\n"


def test_on_a_terminal_preparations_say_how_far_they_are(scene: Path) -> None:
    shown = shown_on_a_terminal("capacitance", scene, "--method", "reduced", "--rtol", "0.2")
    for part in ("machine", "targets"):
        assert re.search(rf"\r\x1b\[K{part}: \d+ panels, error [\d.e-]+ of [\d.]+ asked for, [\d.]+ s", shown)


def test_auto_answers_within_the_time_by_what_it_has(scene: Path) -> None:
    """A machine that is prepared roughly where there is no time for more."""
    done = fringe_command(
        "capacitance", scene, "--method", "auto", "--rtol", "1e-6", "--max-seconds", "0.001"
    )
    assert done.returncode == 3
    assert done.stdout.startswith("auto: answered by reduced\n")
    assert done.stderr.endswith("stopped after 0.001 s: an error of 1e-06 was not reached\n")
    reading = fringe.Scene.load(scene).readings("auto", rtol=1e-6, max_seconds=0.001)["front"]
    assert reading.answered_by == "reduced"
    assert reading.change and reading.error["change"] and reading.error["change"] > 1e-6 * abs(reading.change)


def test_the_reduced_method_ends_without_an_answer(scene: Path) -> None:
    words = ("capacitance", scene, "--method", "reduced", "--rtol", "0.01", "--max-seconds", "0.01")
    done = fringe_command(*words)
    assert (done.returncode, done.stdout) == (3, "")
    assert done.stderr == f"fringe: {scene}: stopped after 0.01 s before there was an answer\n"
    loaded = fringe.Scene.load(scene)
    with pytest.raises(RuntimeError, match="interrupted before there was an answer"):
        loaded.readings("reduced", rtol=0.2, max_seconds=0.01)
    assert loaded.readings("reduced", rtol=0.2)["front"].change


@pytest.mark.parametrize("seconds", [0, -1, float("nan"), float("inf")])
def test_a_limit_of_time_is_finite_and_positive(scene: Path, seconds: float) -> None:
    with pytest.raises(fringe.InputError, match="max_seconds .* must be finite and positive"):
        fringe.Scene.load(scene).readings("auto", max_seconds=seconds)
