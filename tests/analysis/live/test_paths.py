"""The paths of a live page, and how wrong input is refused."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis import live
from analysis.pipeline.model_stage import model_module
from analysis.report.index_page import LIVE
from geometries.scene import motion, reader
from geometries.scene.scene import Scene
from tests import scenes
from tests.analysis.synthetic import data_of
from tests.programs import analysis
from tests.waiting import aged

SCENE = live.find_scene(LIVE.scene)


def hand(scene: Scene, frame: motion.Frame) -> Any:
    """The corners of the hand in a frame, in the frame of the world."""
    shape = scene.objects[-1].pose.transform().points(scene.objects[-1].shape.triangles())
    return frame.poses["wrist"].transform().points(shape).reshape(-1, 3)


def test_the_hand_approaches_the_first_sensor() -> None:
    scene = reader.load(SCENE)
    approach = live.of_scene(scene, ())[0]
    heights = [hand(scene, frame)[:, 2].min() for frame in approach.frames]
    np.testing.assert_allclose(heights, live.HEIGHTS, atol=1e-12)
    assert [frame.name for frame in approach.frames][-1] == "10 mm"


def test_the_hand_slides_over_both_edges_of_the_first_sensor() -> None:
    scene = reader.load(SCENE)
    over = live.of_scene(scene, ())[1]
    first, last = hand(scene, over.frames[0]), hand(scene, over.frames[-1])
    np.testing.assert_allclose(first[:, 2].min(), live.EDGE_HEIGHT, atol=1e-12)
    assert first[:, 0].max() < -0.062 and last[:, 0].min() > -0.004


def test_a_motion_comes_first_and_scenes_without_a_target_have_no_other_path() -> None:
    scene = reader.load(SCENE)
    assert [way.name for way in live.of_scene(scene, [motion.at_rest(scene)])] == [
        "motion",
        "approach",
        "over the edge",
    ]
    arm = reader.load(live.find_scene("x_ray_arm"))
    assert live.of_scene(arm, ()) == []


def test_a_target_without_a_link_gets_one_and_no_answer_changes() -> None:
    text = (
        scenes.link("hand")
        + scenes.sensor("front", [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]])
        + scenes.body(
            "hand",
            "cuboid",
            size=[0.08, 0.18, 0.03],
            translation=[0, 0, 0.05],
            rotation={"axis": [0, 1, 0], "degrees": 20},
        )
    )
    movable = live.movable(text)
    scene = reader.loads(movable)
    assert scene.objects[0].link == "hand'" and [link.name for link in scene.links] == ["hand", "hand'"]
    assert live.movable(movable) == movable
    assert [way.name for way in live.of_scene(scene, ())] == ["approach", "over the edge"]
    native = [model_module().Scene.loads(each).capacitance()["sensors"] for each in (text, movable)]
    assert native[0] == native[1]


def test_reference_readings_are_those_of_boundary_elements() -> None:
    scene = reader.load(SCENE)
    way = live.Way("rest", "", (motion.at_rest(scene),))
    native = model_module().Scene.load(str(SCENE))
    calls: list[None] = []
    solved = live.solved(way, native, 0.05, lambda: calls.append(None))
    truth = native.readings("boundary-elements", rtol=0.05)
    assert len(calls) == 1
    assert solved == [{name: [each.change, each.error["change"]] for name, each in truth.items()}]


@pytest.fixture
def library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The file that stands for the library of pages."""
    file = tmp_path / "library.js"
    file.write_text("// none\n")
    monkeypatch.setattr(live, "page_library", lambda: file)
    return file


def test_every_option_of_the_command_acts(
    library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[float] = []
    monkeypatch.setattr(
        live, "solved", lambda path, scene, rtol, tell: asked.append(rtol) or [{} for _ in path.frames]
    )
    path = tmp_path / "moved.toml"
    path.write_text('[[frame]]\nname = "there"\nposes = [ { link = "wrist", translation = [0, 0, 0.5] } ]\n')
    page = tmp_path / "page.html"
    command = ["live", LIVE.scene, "--output", page]
    analysis(*command, "--motion", path, "--no-reference")
    found = data_of(page)
    assert [way["name"] for way in found["paths"]] == ["motion", "approach", "over the edge"]
    assert found["paths"][0]["frames"][0]["poses"][0]["translation"] == [0, 0, 0.5]
    assert all(way["reference"] is None for way in found["paths"]) and not asked
    analysis(*command, "--rtol", "0.2")
    assert asked == [0.2, 0.2]
    assert all(way["reference"] == [{} for _ in way["frames"]] for way in data_of(page)["paths"])
    analysis(*command, "--rtol", "0.2", "--no-reference", status=2)


@pytest.mark.parametrize("arguments", [["sensor_head", "--rtol", "2"], ["no_such_scene"], ["none.toml"]])
def test_wrong_input_is_refused(
    arguments: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = analysis("live", *arguments, status=2)
    assert done.stdout == "" and done.stderr.strip()
    assert list(tmp_path.iterdir()) == []


def test_a_page_that_would_be_too_large_is_refused(
    library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live, "LARGEST", 1000)
    with pytest.raises(live.InputError, match=r"its page would have 0\.\d MB"):
        live.make(LIVE.scene, None, tmp_path / "page.html", None)
    assert not (tmp_path / "page.html").exists()


def test_without_the_library_the_command_says_how_to_get_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live, "page_library", lambda: tmp_path / "fringe_page.js")
    with pytest.raises(live.NoLibrary, match="apt-get install emscripten"):
        live.make(LIVE.scene, None, tmp_path / "page.html")
    assert list(tmp_path.iterdir()) == []


def test_a_page_that_is_up_to_date_stays(library: Path, tmp_path: Path) -> None:
    target = tmp_path / "page.html"
    live.make(LIVE.scene, None, target, None)
    before = aged(target)
    live.make(LIVE.scene, None, target, None)
    assert target.stat().st_mtime_ns == before
    library.write_text("// another\n")
    live.make(LIVE.scene, None, target, None)
    assert target.stat().st_mtime_ns != before
