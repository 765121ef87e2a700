"""The page of a scene: what its data say, that it needs nothing but itself, and how wrong input is refused."""

import re
from pathlib import Path

import numpy as np
import pytest
from plotly.offline import get_plotlyjs

from analysis import __main__ as command_line, show
from analysis.pipeline.model_stage import model_module
from geometries.scene import motion, reader
from tests import scenes
from tests.analysis.synthetic import data_of
from tests.programs import in_this_process
from tests.waiting import aged

SCENE = (
    scenes.link("arm", translation=[0, 0, 1])
    + scenes.link("hand", parent="arm", translation=[0.1, 0, 0])
    + scenes.sensor("skin", [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]], link="hand")
    + scenes.eye("eye", [0, 0, 0], [0, 0, -2], 60, 0.9, link="hand")
    + scenes.body("floor </script>", "plate", size=[4, 4])
    + scenes.body("ball", "sphere", radius=0.2, segments=8, link="arm", translation=[0, 1, 0])
)

MOTION = scenes.table("frame") + scenes.table(
    "frame",
    name="lowered",
    poses=[{"link": "arm", "translation": [0, 0, 0.5], "rotation": {"axis": [0, 0, 1], "degrees": 90}}],
)


def test_bodies_are_where_the_model_has_them_in_every_frame(scene: Path, tmp_path: Path) -> None:
    data = data_of(show.make(str(scene), None, tmp_path / "page.html"))
    live = model_module().Scene.load(str(scene))
    assert [frame["name"] for frame in data["frames"]] == ["frame 1", "lowered"]
    for frame, height in zip(data["frames"], (1.0, 0.5)):
        if height == 0.5:
            live.set_pose("arm", [0, 0, 0.5], [np.sqrt(0.5), 0, 0, np.sqrt(0.5)])
        conductors = live.conductors()
        for body in data["objects"] + data["sensors"]:
            vertices = np.array(body["vertices"])
            if body["link"] is not None:
                matrix = np.array(frame["links"][body["link"]]).reshape(3, 4)
                vertices = vertices @ matrix[:, :3].T + matrix[:, 3]
            triangles = vertices[np.array(body["faces"])]
            assert triangles == pytest.approx(conductors[body["name"]], abs=2e-5)


def test_readings_are_those_of_the_model(scene: Path, tmp_path: Path) -> None:
    data = data_of(show.make(str(scene), None, tmp_path / "page.html"))
    first, second = data["frames"]
    assert first["readings"] == [None]  # the floor is out of range
    assert second["readings"][0]["distance"] == pytest.approx(0.5)
    assert second["readings"][0]["object"] == "floor </script>"
    live = model_module().Scene.load(str(scene))
    (expected,) = live.capacitance()["sensors"]
    (output,) = first["outputs"]
    assert output["delta_voltage"] == expected["delta_voltage"]
    assert output["total"] == expected["total"]
    assert {name for name, _ in output["objects"]} == {"floor </script>", "ball"}


def test_boxes_hold_their_objects(scene: Path, tmp_path: Path) -> None:
    data = data_of(show.make(str(scene), None, tmp_path / "page.html"))
    ball = data["objects"][1]
    corners, vertices = np.array(ball["obb"]), np.array(ball["vertices"])
    origin, edges = corners[0], corners[[4, 2, 1]] - corners[0]
    shares = (vertices - origin) @ np.linalg.inv(edges)
    assert shares.min() > -1e-3 and shares.max() < 1 + 1e-3
    assert data["frames"][0]["aabb"][1] == pytest.approx([-0.2, 0.8, 0.8, 0.2, 1.2, 1.2], abs=2e-5)
    assert data["frames"][1]["aabb"][1] == pytest.approx([-1.2, -0.2, 0.3, -0.8, 0.2, 0.7], abs=2e-5)


def test_marks_are_the_pairs_that_are_not_clear(scene: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pairs = [
        {"a": "ball", "b": "floor </script>", "status": status} for status in ("clear", "bounds", "collision")
    ]
    answer = {"tests": {"broad": 3, "narrow": 2}, "pairs": pairs}
    monkeypatch.setattr(model_module().Scene, "collide", lambda _: answer)
    read = reader.load(scene)
    data = show.collect(scene, read, (motion.at_rest(read),), model_module())
    assert data["frames"][0]["collisions"] == {
        "tests": {"broad": 3, "narrow": 2},
        "pairs": [["ball", "floor </script>", "bounds"], ["ball", "floor </script>", "collision"]],
    }


def test_outputs_that_the_model_refuses_are_left_out_with_its_reason(scene: Path, tmp_path: Path) -> None:
    scene.write_text(SCENE + 'potential = "floating"\n')
    frame = data_of(show.make(str(scene), None, tmp_path / "page.html"))["frames"][0]
    assert frame["outputs"] is None
    assert 'object "ball" is floating' in frame["refused"]


def test_contact_is_no_number(scene: Path, tmp_path: Path) -> None:
    touching = 'shape = { type = "plate", size = [1, 1] }\nlink = "hand"\n'
    scene.write_text(SCENE + f'\n[[object]]\nname = "touching"\n{touching}')
    (output,) = data_of(show.make(str(scene), None, tmp_path / "page.html"))["frames"][0]["outputs"]
    assert (output["total"], output["objects"][0]) == (None, ["touching", None])


def test_a_scene_without_a_motion_has_one_frame(scene: Path, tmp_path: Path) -> None:
    scene.with_suffix(".motion.toml").unlink()
    data = data_of(show.make(str(scene), None, tmp_path / "page.html"))
    assert [frame["name"] for frame in data["frames"]] == ["as in the scene"]


def test_the_page_needs_nothing_but_itself(scene: Path, tmp_path: Path) -> None:
    page = show.make(str(scene), None, tmp_path / "page.html").read_text()
    own = page.replace(get_plotlyjs(), "")
    assert "http" not in own
    assert not re.search(r"<(script|link|img)[^>]*\b(src|href)=", own)


def run(*arguments: object) -> tuple[int, str, str]:
    """The command's status, and what it prints on its outputs."""
    done = in_this_process(command_line.main, "show", *arguments)
    return done.returncode, done.stdout, done.stderr


def test_the_example_is_shown_by_its_name(tmp_path: Path) -> None:
    target = tmp_path / "arm.html"
    assert run("x_ray_arm", "--output", target) == (0, f"page: {target}\n", "")
    data = data_of(target)
    assert len(data["frames"]) >= 10
    assert len(data["eyes"]) == 4
    # The motion means something: every distance sensor sees the patient in some frame.
    for number in range(4):
        seen = {frame["readings"][number]["object"] for frame in data["frames"] if frame["readings"][number]}
        assert seen & {"torso", "head", "left arm", "right arm"}


def test_an_unknown_name_is_refused_with_those_that_are_known(tmp_path: Path) -> None:
    status, printed, errors = run("none", "--output", tmp_path / "page.html")
    assert (status, printed) == (2, "") and "x_ray_arm" in errors and not (tmp_path / "page.html").exists()


def test_readings_along_the_motion_are_those_of_the_library(tmp_path: Path) -> None:
    target, short = tmp_path / "page.html", tmp_path / "short.motion.toml"
    short.write_text(
        '[[frame]]\njoints = [ { joint = "slide", position = -0.01 } ]\n'
        '[[frame]]\njoints = [ { joint = "slide", position = 0.01 } ]\n'
    )
    asked = ("--readings", "--between", 1, "--rtol", 0.05, "--motion", short, "--output", target)
    assert run("position_sensor", *asked)[0] == 0
    series = {method["name"]: method for method in data_of(target, "along-data")["methods"]}
    assert [series[name]["frames"] for name in ("model", "boundary elements")] == [[0, 1, 2], [0, 2]]
    live = model_module().Scene.load(str(show.find_scene("position_sensor")))
    live.set_joint("slide", 0.0)
    model, solved = live.readings("exact"), live.readings("reduced", rtol=show.RTOL_OF_REDUCED)
    for name in ("electrode 1", "electrode 3"):
        assert series["model"]["changes"][name][1] == pytest.approx(model[name].change, rel=1e-9)
        assert series["reduced"]["changes"][name][1] == pytest.approx(solved[name].change, rel=1e-9)
        assert series["reduced"]["errors"][name][1] == pytest.approx(solved[name].error["change"], rel=1e-6)
    written = aged(target)
    assert run("position_sensor", *asked)[0] == 0
    assert target.stat().st_mtime_ns == written


def test_options_of_the_readings_need_them(scene: Path) -> None:
    told = "analysis: --between is an option of --readings, which is missing\n"
    assert run(scene, "--between", 3) == (2, "", told)
