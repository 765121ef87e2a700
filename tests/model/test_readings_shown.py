"""Readings as they print themselves, and as tables and plots of other packages."""

from __future__ import annotations

import re
from pathlib import Path

import fringe
import numpy as np
import pytest

SCENE = """
[[link]]
name = "hand"
translation = [0, 0, 0.05]
[[sensor]]
name = "<front>"
plates = [ { corner = [-0.05, -0.05, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] } ]
[[sensor]]
name = "side"
plates = [ { corner = [0.1, -0.05, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] } ]
[[object]]
name = "palm"
link = "hand"
shape = { type = "cuboid", size = [0.08, 0.1, 0.02] }
target = true
"""
NAMES = ["<front>", "side"]
PARTS = ("value", "background", "change")
NUMBER = r"-?[\d.]+(e-?\d+)?"


@pytest.fixture(scope="module")
def reading() -> fringe.Reading:
    return fringe.Scene.loads(SCENE).readings()["<front>"]


def moved(count: int, method: str = "auto") -> fringe.MotionReadings:
    """The readings while the hand goes away."""
    poses = np.tile(np.eye(4), (count, 1, 1, 1))
    poses[:, 0, 2, 3] = np.linspace(0.05, 0.15, count)
    return fringe.Scene.loads(SCENE).readings_of(poses, method)


@pytest.fixture(scope="module")
def motion() -> fringe.MotionReadings:
    return moved(3)


def test_a_reading_prints_its_numbers_with_errors_and_unit(reading: fringe.Reading) -> None:
    parts = ", ".join(rf"{part} {NUMBER} ± {NUMBER} pF" for part in PARTS)
    assert re.fullmatch(rf"<fringe\.Reading <front>: {parts}, by [a-z-]+>", repr(reading))
    assert f"change {1e12 * reading.change:.6g} ± {1e12 * reading.error['change']:.2g} pF" in repr(reading)
    assert reading.name == "<front>"


def test_what_is_not_known_is_said() -> None:
    model = fringe.Scene.loads(SCENE).readings("exact")["side"]
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
