"""Sweeps: the readings in every frame of a motion, by the command and in Python, and a single frame."""

import csv
import io
import json
import os
import subprocess
from pathlib import Path
from typing import Any

import fringe
import numpy as np
import pytest

from geometries.scene import reader
from tests import scenes
from tests.programs import fringe_command

REPOSITORY = Path(reader.__file__).parents[2]

SCENE = (
    scenes.link("wrist", translation=[0, 0, 0.05])
    + scenes.SENSOR
    + scenes.body(
        "hand, left", "cuboid", size=[0.08, 0.1, 0.02], link="wrist", translation=[0, 0, 0.01], target=True
    )
    + scenes.body("table", "cuboid", size=[0.3, 0.3, 0.02], translation=[0, 0, -0.05])
    + scenes.table("reading", name="self, front", sense="front", drive=["front"], threshold=100e-15)
)
HEIGHTS = (0.3, 0.1, 0.03)
MOTION = "".join(
    f'[[frame]]\nname = "{name}"\nposes = [ {{ link = "wrist", translation = [0, 0, {height}] }} ]\n'
    for name, height in zip(("far", "near", "near"), HEIGHTS, strict=True)
)


def rows(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


def told(done: subprocess.CompletedProcess[str]) -> list[str]:
    """Returns the lines of standard error that are no remarks on the scene."""
    return [line for line in done.stderr.splitlines() if not line.startswith("fringe: remark: ")]


def answer_at(scene: Path, height: float) -> fringe.Reading:
    there = scene.with_name("there.toml")
    there.write_text(SCENE.replace("[0, 0, 0.05]", f"[0, 0, {height}]"))
    return fringe.Scene.load(str(there)).readings("boundary-elements", rtol=1e-2)["self, front"]


def test_every_frame_has_the_reading_of_the_scene_in_its_poses(scene: Path) -> None:
    done = fringe_command("sweep", scene, "--method", "boundary-elements", "--rtol", "0.01")
    assert (done.returncode, done.stderr) == (0, "")
    found = rows(done.stdout)
    in_python = fringe.Scene.load(str(scene)).readings_of(
        str(scene.with_suffix(".motion.toml")), "boundary-elements", rtol=1e-2
    )
    assert [row["name"] for row in found] == in_python.frames == ["far", "near", "near"]
    for number, (row, height) in enumerate(zip(found, HEIGHTS, strict=True)):
        expected = answer_at(scene, height)
        assert row["reading"] == "self, front" and row["answered_by"] == "boundary-elements"
        for part in ("value", "background", "change"):
            assert float(row[f"{part}_F"]) == getattr(expected, part)
            assert float(row[f"{part}_error_F"]) == expected.error[part]
            assert getattr(in_python, part)[number, 0] == getattr(expected, part)
            assert in_python.error[part][number, 0] == expected.error[part]
        noticed = expected.change - expected.error["change"] > 100e-15
        assert row["noticed"] == ("yes" if noticed else "no")


def test_the_voltage_is_that_of_the_divider_with_and_without_the_target(scene: Path) -> None:
    coupling, input_voltage = 27e-12, 2.5
    scene.write_text(
        SCENE.replace(
            'name = "front"\n', f'name = "front"\ncoupling_capacitance = {coupling}\ninput_voltage = 2.5\n', 1
        )
    )
    for row in rows(fringe_command("sweep", scene, "--method", "reduced").stdout):
        with_target, without = (
            input_voltage * coupling / (coupling + float(row[part])) for part in ("value_F", "background_F")
        )
        assert float(row["delta_voltage_V"]) == pytest.approx(without - with_target, rel=1e-9)


def test_what_the_model_does_not_know_is_empty(scene: Path) -> None:
    for row in rows(fringe_command("sweep", scene).stdout):
        assert row["value_F"] == row["background_F"] == row["delta_voltage_V"] == row["change_error_F"] == ""
        assert float(row["change_F"]) > 0


def test_with_a_file_the_command_says_where_the_threshold_is_crossed(scene: Path) -> None:
    target = scene.parent / "new folder" / "sweep.csv"
    done = fringe_command(
        "sweep", scene, "--method", "boundary-elements", "--rtol", "0.03", "--output", target
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert (
        "self, front, threshold 100 fF: not noticed from frame 1 (far), noticed from frame 2 (near)"
        in done.stdout
    )
    assert [row["noticed"] for row in rows(target.read_text())] == ["no", "yes", "yes"]


def test_the_guide_shows_what_the_command_prints(tmp_path: Path) -> None:
    guide = (REPOSITORY / "model" / "GUIDE.md").read_text().replace("\n    ", "\n")
    options = ("--method", "boundary-elements", "--rtol", "0.02", "--output", tmp_path / "sweep.csv")
    done = fringe_command("sweep", REPOSITORY / "geometries/scenes/guarded_sensor.toml", *options)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.replace(f"{tmp_path}/", "") in guide


def test_an_error_around_the_threshold_leaves_it_open(scene: Path) -> None:
    change = answer_at(scene, HEIGHTS[1]).change
    scene.write_text(SCENE.replace("1e-13", repr(change * (1 + 1e-6))))
    found = rows(fringe_command("sweep", scene, "--method", "boundary-elements", "--rtol", "0.01").stdout)
    assert [row["noticed"] for row in found] == ["no", "unsure", "yes"]


METHODS = "exact,formula,exact+facing"


def test_several_methods_have_a_row_each_in_every_frame(scene: Path) -> None:
    methods, more = "exact,reduced,exact+facing", "auto,boundary-elements"
    done = fringe_command("sweep", scene, "--method", methods, "--method", more, "--rtol", "0.03")
    assert (done.returncode, told(done)) == (0, [])
    found = rows(done.stdout)
    asked = [*methods.split(","), *more.split(",")]
    assert [row["method"] for row in found] == 3 * asked
    motion_file = str(scene.with_suffix(".motion.toml"))
    for number, method in enumerate(methods.split(",")):
        options = {"rtol": 0.03} if method == "reduced" else {}
        expected = fringe.Scene.load(str(scene)).readings_of(motion_file, method, **options)
        own = found[number :: len(asked)]
        assert [float(row["change_F"]) for row in own] == list(expected.change[:, 0])
    assert {row["answered_by"] for row in found if row["method"] == "auto"} <= {"formula", "reduced"}
    for row in found:
        assert row["reached"] == ("" if row["method"].startswith("exact") else "yes")


def test_a_stopped_sweep_is_completed_and_its_rows_are_kept(scene: Path) -> None:
    target = scene.with_name("sweep.csv")
    asked = ("sweep", scene, "--method", METHODS, "--output", target)
    whole = fringe_command(*asked) and target.read_text()
    header, *lines = whole.splitlines()
    # A number that no computation gives shows that the row is not computed again.
    kept = [line.replace(line.split(",")[-7], "1.5", 1) for line in lines[:4]]
    target.write_text("\n".join([header, *kept]) + "\n")
    done = fringe_command(*asked)
    assert (done.returncode, done.stderr) == (0, "")
    assert "3 frames, 1 of which were there" in done.stdout
    assert target.read_text().splitlines() == [header, *kept, *lines[4:]]


MESH = "v 0 0 0\nv .05 0 0\nv .05 .05 0\nv 0 .05 0\nf 1 2 3 4\n"


@pytest.mark.parametrize(
    ("file", "old", "new", "kept"),
    [
        ("a scene.toml", "[0.3, 0.3, 0.02]", "[0.3, 0.3, 0.03]", 0),
        ("a scene.toml", "1e-13", "9e-14", 0),
        ("hand.obj", "v 0 0 0", "v 0 0 0.01", 0),
        ("a scene.motion.toml", "0.03", "0.04", 2),
    ],
)
def test_what_changed_is_computed_again_and_the_other_frames_are_kept(
    scene: Path, file: str, old: str, new: str, kept: int
) -> None:
    scene.write_text(SCENE.replace('"cuboid", size = [0.08, 0.1, 0.02]', '"mesh", file = "hand.obj"'))
    scene.with_name("hand.obj").write_text(MESH)
    asked = ("sweep", scene, "--output", scene.with_name("sweep.csv"))
    fringe_command(*asked)
    before = rows(asked[-1].read_text())
    changed = scene.with_name(file)
    changed.write_text(changed.read_text().replace(old, new))
    done = fringe_command(*asked)
    after = rows(asked[-1].read_text())
    assert done.returncode == 0 and after[:kept] == before[:kept]
    assert not {row["key"] for row in before[kept:]} & {row["key"] for row in after[kept:]}
    if kept:
        assert f"3 frames, {kept} of which were there" in done.stdout
    else:
        assert "of another scene, motion or options, and are replaced" in done.stderr


def test_a_file_that_is_no_table_of_a_sweep_is_not_replaced(scene: Path) -> None:
    target = scene.with_name("notes.csv")
    target.write_text("my,notes\n")
    done = fringe_command("sweep", scene, "--output", target)
    assert done.returncode == 2 and "is no table of a sweep" in done.stderr
    assert target.read_text() == "my,notes\n"
    os.mkfifo(scene.with_name("pipe"))
    done = fringe_command("sweep", scene, "--output", scene.with_name("pipe"))
    assert done.returncode == 2 and "pipe is no file" in done.stderr


def test_a_place_that_cannot_be_written_is_told_before_a_frame_is_answered(scene: Path) -> None:
    scene.with_suffix(".motion.toml").write_text(MOTION.replace("0.3]", "0]"))
    done = fringe_command("sweep", scene, "--method", "boundary-elements", "--output", "/proc/s.csv")
    assert done.returncode == 1 and "/proc/s.csv: cannot be written" in done.stderr
    assert "frame" not in done.stderr


def test_a_row_that_is_less_accurate_than_asked_for_ends_with_status_3_also_when_it_is_kept(
    scene: Path,
) -> None:
    asked = ("sweep", scene, "--method", "reduced", "--rtol", "1e-5", "--output", scene.with_name("s.csv"))
    first = fringe_command(*asked)
    assert first.returncode == 3 and "an error of 1e-05 was not reached in every frame" in first.stderr
    again = fringe_command(*asked)
    assert again.returncode == 3 and "3 of which were there" in again.stdout


def test_a_method_without_an_answer_leaves_its_row_empty_and_says_why_once(scene: Path) -> None:
    scene.with_suffix(".motion.toml").write_text(MOTION.replace("0.03", "-0.005").replace("0.1]", "0]"))
    done = fringe_command("sweep", scene, "--method", "exact,boundary-elements", "--rtol", "0.1")
    assert done.returncode == 0
    (line,) = told(done)
    assert "boundary-elements: no answer in frames 2, 3: " in line
    of_bem = [row for row in rows(done.stdout) if row["method"] == "boundary-elements"]
    assert [row["answered_by"] for row in of_bem] == ["boundary-elements", "", ""]
    assert of_bem[1]["change_F"] == of_bem[1]["key"] == ""


def test_frames_without_any_answer_are_empty_unless_all_are(scene: Path) -> None:
    motion_file = scene.with_suffix(".motion.toml")
    motion_file.write_text(MOTION.replace("0.1]", "0]"))
    asked = ("sweep", scene, "--method", "boundary-elements", "--rtol", "0.1")
    done = fringe_command(*asked)
    assert done.returncode == 3 and "no answer in frames 2: " in done.stderr
    assert [row["answered_by"] for row in rows(done.stdout)] == ["boundary-elements", "", "boundary-elements"]
    found = fringe.Scene.load(str(scene)).readings_of(str(motion_file), "boundary-elements", rtol=0.1)
    assert np.isnan(found.change[:, 0]).tolist() == [False, True, False]
    motion_file.write_text(
        MOTION.split("[[frame]]")[0] + "[[frame]]" + MOTION.split("[[frame]]")[1].replace("0.3", "0")
    )
    output = scene.with_name("s.csv")
    done = fringe_command(*asked, "--output", output)
    assert (done.returncode, done.stdout, output.exists()) == (2, "", False)
    assert "frame 1 (far): " in done.stderr
    with pytest.raises(fringe.InputError):
        fringe.Scene.load(str(scene)).readings_of(str(motion_file), "boundary-elements", rtol=0.1)


@pytest.mark.parametrize("frame", ["far", "1"])
def test_capacitance_answers_in_one_frame(scene: Path, frame: str) -> None:
    of_frame = json.loads(fringe_command("capacitance", scene, "--frame", frame, "--json").stdout)
    there = scene.with_name("there.toml")
    there.write_text(SCENE.replace("[0, 0, 0.05]", "[0, 0, 0.3]"))
    assert of_frame["sensors"] == json.loads(fringe_command("capacitance", there, "--json").stdout)["sensors"]


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (("--frame", "near"), 'scene.motion.toml: 2 frames are named "near": give a number from 1 to 3'),
        (("--frame", "4"), 'scene.motion.toml: there is no frame "4": give a name or a number from 1 to 3'),
        (("--frame", "1", "--motion", "no.toml"), "no.toml: the file does not exist or is not a file"),
        (("--motion", "no.toml"), "--motion without --frame"),
    ],
)
def test_a_frame_that_is_none_is_refused(scene: Path, options: tuple[str, ...], reason: str) -> None:
    done = fringe_command("capacitance", scene, *options)
    assert (done.returncode, done.stdout) == (2, "")
    assert reason in done.stderr


@pytest.mark.parametrize(
    ("options", "python"),
    [
        (("--method", "exact+nearest"), {"method": "exact+nearest"}),
        (("--rtol", "0.1"), {"rtol": 0.1}),
        (("--motion", "other.toml"), {"method": "exact"}),
    ],
)
def test_a_sweep_takes_the_options_of_the_method_and_a_motion(
    scene: Path, monkeypatch: pytest.MonkeyPatch, options: tuple[str, ...], python: dict[str, Any]
) -> None:
    monkeypatch.chdir(scene.parent)
    scene.with_name("other.toml").write_text(MOTION.replace("0.03", "0.2"))
    file = "other.toml" if options[0] == "--motion" else "a scene.motion.toml"
    found = [float(row["change_F"]) for row in rows(fringe_command("sweep", scene, *options).stdout)]
    expected = fringe.Scene.load(str(scene)).readings_of(file, **python)
    assert found == list(expected.change[:, 0])


def test_a_sweep_ends_after_its_time_with_the_frames_that_are_finished(scene: Path) -> None:
    scene.with_suffix(".motion.toml").write_text("[[frame]]\n" * 400)
    words = ("--method", "boundary-elements", "--rtol", "1e-3", "--max-seconds", "2")
    done = fringe_command("sweep", scene, *words)
    assert done.returncode == 3
    finished = len(rows(done.stdout))
    assert finished < 400
    assert f"stopped after 2 s after {finished} of 400 frames" in done.stderr


def test_a_method_that_is_none_and_a_scene_without_a_motion_are_refused(scene: Path) -> None:
    unknown = fringe_command("sweep", scene, "--method", "exact,bem")
    scene.with_suffix(".motion.toml").unlink()
    missing = fringe_command("sweep", scene)
    for done, told in (
        (unknown, "method 'bem' is not known: it must be exact, split:N"),
        (missing, "scene.motion.toml: the file does not exist"),
    ):
        assert (done.returncode, done.stdout) == (2, "") and told in done.stderr


def test_a_motion_may_be_an_array_of_poses(scene: Path) -> None:
    live = fringe.Scene.load(str(scene))
    found = live.readings_of(str(scene.with_suffix(".motion.toml")), "reduced", rtol=0.1)
    assert (found.frames, found.readings, len(found)) == (["far", "near", "near"], ["self, front"], 3)
    assert found.answered_by == 3 * [["reduced"]] and (found.error["background"] > 0).all()
    poses = np.tile(np.eye(4), (len(HEIGHTS), 1, 1, 1))
    poses[:, 0, 2, 3] = HEIGHTS
    assert live.readings_of(poses, "reduced", rtol=0.1).change.tolist() == found.change.tolist()
    with pytest.raises(fringe.InputError, match=r"shape \(frames, 1, 4, 4\)"):
        live.readings_of(poses[:, :, :3], "reduced")
