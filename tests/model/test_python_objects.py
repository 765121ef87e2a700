"""The Python module: scenes in other processes, objects that come and go, entries by their names, and the stubs of the types."""

import multiprocessing
import os
import pickle
import subprocess
import sys
import tomllib
from pathlib import Path

import fringe
import numpy as np
import pytest

from tests import scenes

ROOT = Path(__file__).resolve().parents[2]
STUBS = ROOT / "model/python/fringe-stubs"
SCENE = (
    scenes.link("arm")
    + scenes.SENSOR
    + scenes.body("hand", "mesh", file="hand.obj", link="arm")
    + scenes.body("table", "plate", size=[0.3, 0.3], translation=[0, 0, -0.1])
)
TRIANGLE = "v -0.03 -0.03 0\nv 0.03 -0.03 0\nv 0 0.03 0\nf 1 2 3\n"
BALL = scenes.body("ball", "sphere", radius=0.02, segments=8, translation=[0, 0, 0.2])


@pytest.fixture
def scene(tmp_path: Path) -> fringe.Scene:
    (tmp_path / "hand.obj").write_text(TRIANGLE)
    (tmp_path / "scene.toml").write_text(SCENE)
    scene = fringe.Scene.load(tmp_path / "scene.toml")
    scene.set_pose("arm", [0.01, 0, 0.08], [1, 0.1, 0.2, 0.3])
    return scene


def total(scene: fringe.Scene) -> float:
    return float(scene.capacitance()["sensors"][0]["total"])


def test_a_pickled_scene_has_its_poses_and_what_was_done_to_it(scene: fringe.Scene) -> None:
    scene.hide("table")
    scene.add(BALL)
    again = pickle.loads(pickle.dumps(scene))
    assert again.objects == scene.objects == ["hand", "ball"]
    np.testing.assert_array_equal(again.pose("arm"), scene.pose("arm"))
    assert total(again) == total(scene)
    again.show("table")
    assert again.objects == ["hand", "table", "ball"]


def test_scenes_are_answered_in_other_processes(scene: fringe.Scene) -> None:
    other = scene.copy()
    other.set_pose("arm", [0, 0, 0.3])
    # Threads of this process may hold locks that a fork would copy.
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.map(total, [scene, other]) == [total(scene), total(other)]


def test_what_is_hidden_is_as_if_it_were_not_there(scene: fringe.Scene) -> None:
    whole, without = total(scene), fringe.Scene.loads(SCENE.split("[[object]]")[0])
    scene.hide("table")
    scene.hide("table")
    assert scene.objects == ["hand"] and total(scene) < whole
    scene.hide("hand")
    assert total(scene) == total(without) == 0
    for name in ("table", "hand"):
        scene.show(name)
    assert total(scene) == whole


def test_what_is_added_stands_in_the_scene_as_it_is_now(scene: fringe.Scene) -> None:
    pose = scene.pose("arm")
    scene.add(scenes.body("watch", "cube", size=0.01, link="arm"))
    np.testing.assert_array_equal(scene.pose("arm"), pose)
    np.testing.assert_allclose(scene.conductors()["watch"].mean(axis=(0, 1)), pose[:3, 3], atol=1e-12)


@pytest.mark.parametrize(
    "text, words",
    [
        (scenes.body("hand", "cube", size=1), "hand"),
        (scenes.body("b", "cube", size=1, link="leg"), "leg"),
        ("[[object", "scene:"),
    ],
)
def test_a_wrong_addition_leaves_the_scene_as_it_was(scene: fringe.Scene, text: str, words: str) -> None:
    before = total(scene)
    with pytest.raises(fringe.InputError, match=words):
        scene.add(text)
    assert scene.objects == ["hand", "table"] and total(scene) == before


def test_what_cannot_be_hidden_is_named(scene: fringe.Scene) -> None:
    with pytest.raises(fringe.InputError, match='there is no object "nobody"'):
        scene.hide("nobody")
    scene.add(scenes.body("pad", "cube", size=0.01, translation=[1, 0, 0], potential="electrode"))
    with pytest.raises(fringe.InputError, match='"pad" is an electrode'):
        scene.hide("pad")
    alone = fringe.Scene.loads(scenes.body("ball", "cube", size=1))
    with pytest.raises(fringe.InputError, match="at least one"):
        alone.hide("ball")
    assert alone.objects == ["ball"]


def test_entries_by_their_names(scene: fringe.Scene) -> None:
    sensors = fringe.by_name(scene.capacitance()["sensors"])
    assert list(sensors) == ["front"] and list(fringe.by_name(sensors["front"]["objects"])) == [
        "hand",
        "table",
    ]


@pytest.mark.night
def test_the_stubs_are_those_of_the_module(tmp_path: Path) -> None:
    """As mypy's own test of stubs sees it, in a folder like the one where both are installed."""
    for module in (ROOT / "build/python").glob("fringe.*.so"):
        (tmp_path / module.name).symlink_to(module)
    (tmp_path / "fringe-stubs").symlink_to(STUBS)
    # The metaclass of pybind11 and its inherited constructor differ from those that stubs can describe.
    allowed = (
        f"fringe.{name}{part}"
        for name in ("MachinePotentials", "MotionReadings", "Reading", "Scene")
        for part in ("", ".__init__")
    )
    (tmp_path / "allowed").write_text("\n".join([*allowed, "fringe.InterruptionScope"]))
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "mypy.stubtest",
            "fringe",
            "--ignore-positional-only",
            "--allowlist",
            "allowed",
        ],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(tmp_path), "MYPYPATH": str(tmp_path)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_stubs_name_every_argument() -> None:
    """Which mypy's test of stubs cannot see of a module of C++."""
    stubs = (STUBS / "__init__.pyi").read_text()
    for owner, own in ((fringe, stubs), (fringe.Scene, stubs.split("class Scene:")[1])):
        for name, member in vars(owner).items():
            signature = (getattr(member, "__doc__", None) or "").split("->")[0]
            if name.startswith("_") or not signature.startswith(f"{name}("):
                continue
            stub = own.split(f"def {name}(")[1].split("->")[0]
            for word in signature.split("(", 1)[1].split(","):
                argument = word.strip(" ()").split(":")[0]
                assert argument in ("", "self", "*", "**kwargs") or f"{argument}:" in stub, (name, argument)


def test_a_dictionary_is_a_scene_as_its_text_is(tmp_path: Path, scene: fringe.Scene) -> None:
    described = tomllib.loads(SCENE)
    described["sensor"][0]["plates"][0]["edge_u"] = np.array([0.1, 0, 0])
    described["object"][1]["collides"] = np.bool_(True)
    made = fringe.Scene.loads(described, tmp_path)
    made.set_pose("arm", scene.pose("arm"))
    assert made.conductors().keys() == scene.conductors().keys()
    for name, triangles in made.conductors().items():
        np.testing.assert_array_equal(triangles, scene.conductors()[name])
    made.add(tomllib.loads(BALL))
    scene.add(BALL)
    assert total(made) == total(scene)


def test_names_of_all_characters_survive_a_dictionary() -> None:
    name = 'a "quoted"\\ 左\t\x7f\0'
    made = fringe.Scene.loads({"object": [{"name": name, "shape": {"type": "cube", "size": 1}}]})
    assert made.objects == [name]
    assert list(made.roles()["objects"]) == [name]


@pytest.mark.parametrize(
    ("description", "words"),
    [
        ({"object": [{"name": None}]}, r"object\[0\].name: must be a text"),
        ({"sensor": [{"name": "s", "plates": [{"corner": [0, 0, {1}]}]}]}, r"corner\[2\]: must be a text"),
        (["object"], "must be a text or a dictionary"),
        ({"object": [{"name": "a", "shape": {"type": "cube", "size": float("nan")}}]}, "size"),
    ],
)
def test_a_wrong_dictionary_is_refused_with_its_key(description: object, words: str) -> None:
    with pytest.raises(fringe.InputError, match=words):
        fringe.Scene.loads(description)  # type: ignore[arg-type]
