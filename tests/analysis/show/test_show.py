"""The page of a scene: what its data say, that it needs nothing but itself, and how wrong input is refused."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis.pipeline.model_stage import model_module
from analysis.show import data as show_data, make as show, readings
from geometries.common.installation import ROOT
from geometries.scene import motion, reader
from tests import scenes
from tests.waiting import DEADLINE

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


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "a scene.toml"
    path.write_text(SCENE)
    path.with_name("a scene.motion.toml").write_text(MOTION)
    return path


def data_of(page: Path) -> dict[str, Any]:
    found = re.search(
        r'<script type="application/json" id="data">(.*?)</script>', page.read_text(), flags=re.DOTALL
    )
    assert found is not None
    data: dict[str, Any] = json.loads(found[1])
    return data


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


def test_marks_are_the_pairs_that_are_not_clear(scene: Path) -> None:
    module = model_module()

    class Colliding:
        """The model's scene with a collision test whose answer is known."""

        def __init__(self, path: str) -> None:
            self._scene = module.Scene.load(path)

        def __getattr__(self, name: str) -> Any:
            return getattr(self._scene, name)

        def collide(self) -> dict[str, Any]:
            pairs = [
                {"a": "ball", "b": "floor </script>", "status": status}
                for status in ("clear", "bounds", "collision")
            ]
            return {"tests": {"broad": 3, "narrow": 2}, "pairs": pairs}

    class Model:
        """The model's module with that scene."""

        Scene = type("Scene", (), {"load": staticmethod(Colliding)})
        obb, aabb = staticmethod(module.obb), staticmethod(module.aabb)

    read = reader.load(scene)
    data = show_data.collect(scene, read, (motion.at_rest(read),), Model)
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
    scene.with_name("a scene.motion.toml").unlink()
    data = data_of(show.make(str(scene), None, tmp_path / "page.html"))
    assert [frame["name"] for frame in data["frames"]] == ["as in the scene"]


def test_the_page_needs_nothing_but_itself(scene: Path, tmp_path: Path) -> None:
    page = show.make(str(scene), None, tmp_path / "page.html").read_text()
    own = page.replace(plotly_script(), "")
    assert "http" not in own
    assert not re.search(r"<(script|link|img)[^>]*\b(src|href)=", own)


def plotly_script() -> str:
    from plotly.offline import get_plotlyjs

    script: str = get_plotlyjs()
    return script


def run(*arguments: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "analysis", "show", *map(str, arguments)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False, timeout=DEADLINE)


def test_the_example_is_shown_by_its_name(tmp_path: Path) -> None:
    target = tmp_path / "arm.html"
    done = run("x_ray_arm", "--output", target)
    assert (done.returncode, done.stderr, done.stdout) == (0, "", f"page: {target}\n")
    data = data_of(target)
    assert len(data["frames"]) >= 10
    assert len(data["eyes"]) == 4
    # The motion means something: every distance sensor sees the patient in some frame.
    for number in range(4):
        seen = {frame["readings"][number]["object"] for frame in data["frames"] if frame["readings"][number]}
        assert seen & {"torso", "head", "left arm", "right arm"}


def test_an_unknown_name_is_refused_with_those_that_are_known(tmp_path: Path) -> None:
    done = run("none", "--output", tmp_path / "page.html")
    assert (done.returncode, done.stdout) == (2, "")
    assert "x_ray_arm" in done.stderr and not (tmp_path / "page.html").exists()


def test_readings_along_the_motion_are_those_of_the_library(tmp_path: Path) -> None:
    target = tmp_path / "page.html"
    (tmp_path / "short.motion.toml").write_text(
        '[[frame]]\njoints = [ { joint = "slide", position = -0.01 } ]\n'
        '[[frame]]\njoints = [ { joint = "slide", position = 0.01 } ]\n'
    )
    asked = ("position_sensor", "--readings", "--between", 1, "--rtol", 0.05)
    done = run(*asked, "--motion", tmp_path / "short.motion.toml", "--output", target)
    assert done.returncode == 0, done.stderr
    found = re.search(r'id="along-data">(.*?)</script>', target.read_text())
    assert found is not None
    along = json.loads(found.group(1))
    series = {method["name"]: method for method in along["methods"]}
    assert [series[name]["frames"] for name in ("model", "boundary elements")] == [[0, 1, 2], [0, 2]]
    live = model_module().Scene.load(str(show.find_scene("position_sensor")))
    live.set_joint("slide", 0.0)
    model, solved = live.readings("exact"), live.readings("reduced", rtol=readings.RTOL_OF_REDUCED)
    for name in ("electrode 1", "electrode 3"):
        assert series["model"]["changes"][name][1] == pytest.approx(model[name].change, rel=1e-9)
        assert series["reduced"]["changes"][name][1] == pytest.approx(solved[name].change, rel=1e-9)
        assert series["reduced"]["errors"][name][1] == pytest.approx(solved[name].error["change"], rel=1e-6)
    written = target.stat().st_mtime_ns
    assert run(*asked, "--motion", tmp_path / "short.motion.toml", "--output", target).returncode == 0
    assert target.stat().st_mtime_ns == written


def test_options_of_the_readings_need_them(scene: Path) -> None:
    done = run(scene, "--between", 3)
    assert (done.returncode, done.stdout) == (2, "")
    assert "--between is an option of --readings, which is missing" in done.stderr
