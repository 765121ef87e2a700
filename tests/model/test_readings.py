"""Readings as Python and the command give them, as they print themselves, and as tables and plots of other packages."""

import json
import re
from pathlib import Path
from typing import Any

import fringe
import numpy as np
import pytest

import geometries
from tests import scenes
from tests.programs import fringe_command

SCENES = Path(geometries.__file__).parent / "scenes"
SCENE = SCENES / "guarded_sensor.toml"
PARTS = ("value", "background", "change")
ASKED = ("--method", "boundary-elements", "--rtol", "0.01")


@pytest.fixture(scope="module")
def readings() -> Any:
    return fringe.Scene.load(SCENE).readings("boundary-elements", rtol=1e-2)


def test_the_change_is_the_value_less_the_background(readings: Any) -> None:
    assert list(readings) == ["guarded", "transmitted", "unguarded"]
    for reading in readings.values():
        assert reading.change == pytest.approx(reading.value - reading.background, rel=1e-12)
        assert reading.answered_by == "boundary-elements"


def test_the_command_prints_the_same_readings(readings: Any) -> None:
    document = json.loads(fringe_command("capacitance", SCENE, *ASKED, "--json").stdout)
    for described in document["readings"]:
        reading = readings[described["name"]]
        assert [described[part] for part in PARTS] == [getattr(reading, part) for part in PARTS]
        assert described["error"] == reading.error
    bounded = {described["name"] for described in document["readings"] if "lower" in described}
    assert bounded == {"unguarded"}  # Only the reading that drives just what it senses is an energy.
    table = fringe_command("capacitance", SCENE, *ASKED).stdout.split("Readings, pF")[1]
    assert [line.split()[0] for line in table.splitlines()[1:]] == ["guarded", "unguarded", "transmitted"]


def test_long_names_and_large_errors_keep_the_tables_columns_apart(tmp_path: Path) -> None:
    text = SCENE.read_text().replace("[0, 0, -0.07]", "[0, 0, -0.062]")
    text = text.replace("housing", "housing of the whole machine").replace("unguarded", "without the guard")
    (tmp_path / "scene.toml").write_text(text)
    done = fringe_command("capacitance", tmp_path / "scene.toml", "--method", "reduced", "--entries")
    assert done.returncode == 3  # the guard is 2 mm before the housing
    head, *rows = done.stdout.split("\n\n")[1].splitlines()
    assert head.split("  ")[-1] == "housing of the whole machine"
    for row in rows:
        assert len(row) <= len(head) and row.count(" ± ") == 3
    assert all(line.startswith("  without the guard  ") for line in done.stdout.splitlines()[-2:-1])


def test_info_lists_the_readings_and_what_objects_are_to_them() -> None:
    document = json.loads(fringe_command("info", SCENE, "--json").stdout)
    by_name = {
        kind: {described.pop("name"): described for described in listed}
        for kind, listed in document["roles"].items()
    }
    assert by_name == fringe.Scene.load(SCENE).roles()
    table = fringe_command("info", SCENE).stdout
    assert "reading guarded: senses front, drives front and guard, noise 1 fF, threshold 5 fF" in table
    assert "object guard, electrode" in table and "object hand, target, 100 pF to ground" in table


def test_an_error_that_a_method_cannot_tell_is_null(tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(
        scenes.SENSOR + scenes.body("wall", "plate", size=[10, 10], translation=[0, 0, 0.06], target=True)
    )
    asked = ("capacitance", scene, "--method", "formula")
    (described,) = json.loads(fringe_command(*asked, "--json").stdout)["readings"]
    assert described["change"] > 0 and described["error"]["change"] is None
    table = fringe_command(*asked).stdout
    change = table.split("Readings, pF")[1].split()[-1]
    assert float(change) > 0 and table.rstrip().endswith(change)
    assert fringe.Scene.load(scene).readings("formula")["front"].error["change"] is None


def test_electrodes_of_any_shape_have_readings_that_the_model_does_not_know() -> None:
    scene = fringe.Scene.load(SCENES / "round_electrode.toml")
    assert [reading.change for reading in scene.readings("exact").values()] == [None, None]
    own, transmitted = scene.readings("boundary-elements", rtol=0.1).values()
    assert own.change > own.error["change"] and transmitted.change < -transmitted.error["change"]


TWO_SENSORS = (
    scenes.link("hand", translation=[0, 0, 0.05])
    + scenes.sensor("<front>", [[-0.05, -0.05, 0], [0.1, 0, 0], [0, 0.1, 0]])
    + scenes.sensor("side", [[0.1, -0.05, 0], [0.1, 0, 0], [0, 0.1, 0]])
    + scenes.body("palm", "cuboid", size=[0.08, 0.1, 0.02], link="hand", target=True)
)
NAMES = ["<front>", "side"]
NUMBER = r"-?[\d.]+(e-?\d+)?"


@pytest.fixture(scope="module")
def reading() -> fringe.Reading:
    return fringe.Scene.loads(TWO_SENSORS).readings()["<front>"]


def moved(count: int, method: str = "auto", rtol: float | None = None) -> fringe.MotionReadings:
    """The readings while the hand goes away."""
    poses = np.tile(np.eye(4), (count, 1, 1, 1))
    poses[:, 0, 2, 3] = np.linspace(0.05, 0.15, count)
    return fringe.Scene.loads(TWO_SENSORS).readings_of(poses, method, rtol=rtol)


@pytest.fixture(scope="module")
def motion() -> fringe.MotionReadings:
    return moved(3)


def test_a_reading_prints_its_numbers_with_errors_and_unit(reading: fringe.Reading) -> None:
    parts = ", ".join(rf"{part} {NUMBER} ± {NUMBER} pF" for part in PARTS)
    assert re.fullmatch(rf"<fringe\.Reading <front>: {parts}, by [a-z-]+>", repr(reading))
    assert f"change {1e12 * reading.change:.6g} ± {1e12 * reading.error['change']:.2g} pF" in repr(reading)
    assert reading.name == "<front>"


def test_whether_the_accuracy_was_reached_is_told() -> None:
    scene = fringe.Scene.loads(TWO_SENSORS)
    scene.set_pose("hand", [0, 0, 0.05])
    for method, rtol, reached in (("auto", 1e-2, True), ("reduced", 1e-6, False), ("exact", None, None)):
        assert [each.reached for each in scene.readings(method, rtol=rtol).values()] == [reached] * 2
        assert moved(2, method, rtol).reached == [reached] * 2
    assert scene.maxwell(rtol=1e-2)["reached"]


def test_what_is_not_known_is_said() -> None:
    model = fringe.Scene.loads(TWO_SENSORS).readings("exact")["side"]
    assert "value not known, background not known, change " in repr(model)
    assert "pF, error not known, by exact>" in repr(model)


def test_a_reading_is_a_table_in_a_notebook(reading: fringe.Reading) -> None:
    html = reading._repr_html_()
    assert html.startswith("<table>") and html.endswith("</table>") and "&lt;front&gt;" in html
    for part in PARTS:
        assert f"<th>{part}</th><td>{1e12 * getattr(reading, part):.6g} ± " in html


def test_those_of_a_motion_print_their_frames() -> None:
    found = moved(20, "reduced")
    head, *lines = repr(found).splitlines()
    assert head == "<fringe.MotionReadings of 20 frames: <front>, side>"
    assert len(lines) == 13 and "8 more frames" in lines[-1]
    assert re.fullmatch(rf"  1: change {NUMBER} ± {NUMBER} pF, {NUMBER} ± {NUMBER} pF", lines[0])


def test_they_are_arrays_with_a_row_for_each_frame(motion: fringe.MotionReadings) -> None:
    assert (motion.frames, motion.readings, len(motion)) == (["1", "2", "3"], NAMES, 3)
    assert set(motion.error) == set(PARTS)
    assert [len(answered) for answered in motion.answered_by] == [2, 2, 2]
    for part in PARTS:
        assert getattr(motion, part).shape == motion.error[part].shape == (3, 2)
    assert (np.diff(motion.change[:, 0]) < 0).all()
    assert np.allclose(motion.change, motion.value - motion.background, rtol=0, atol=1e-20)


def test_they_become_a_table_with_the_columns_of_a_sweep(motion: fringe.MotionReadings) -> None:
    pytest.importorskip("pandas")
    table = motion.to_pandas()
    assert list(table["name"]) == ["1", "1", "2", "2", "3", "3"] and list(table["reading"]) == 3 * NAMES
    assert list(table["answered_by"]) == [name for names in motion.answered_by for name in names]
    assert list(table["reached"]) == 6 * [True]
    for part in PARTS:
        assert np.array_equal(table[f"{part}_F"], getattr(motion, part).ravel())
        assert np.array_equal(table[f"{part}_error_F"], motion.error[part].ravel())
    assert "&lt;front&gt;" in motion._repr_html_() and "change_F" in motion._repr_html_()


def test_they_become_a_dataset(motion: fringe.MotionReadings) -> None:
    pytest.importorskip("xarray")
    found = motion.to_xarray()
    assert dict(found.sizes) == {"frame": 3, "reading": 2} and found["change"].attrs == {"units": "F"}
    for part in PARTS:
        assert np.array_equal(found[part].sel(reading="side"), getattr(motion, part)[:, 1])
        assert np.array_equal(found[f"{part}_error"].sel(frame="2"), motion.error[part][1])


def test_they_are_drawn_with_their_errors(motion: fringe.MotionReadings, tmp_path: Path) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib import pyplot

    axes = motion.plot()
    assert [line.get_label() for line in axes.get_lines()] == NAMES
    for column, line in enumerate(axes.get_lines()):
        assert np.allclose(line.get_ydata(), 1e12 * motion.change[:, column])
    assert axes.get_ylabel() == "change (pF)" and len(axes.collections) == 2
    own = pyplot.figure().subplots()
    assert motion.plot("value", axes=own) is own and own.get_ylabel() == "value (pF)"
    own.figure.savefig(tmp_path / "value.png")
    pyplot.close("all")
    with pytest.raises(ValueError, match="no quantity .*value, background, change"):
        motion.plot("charge")
