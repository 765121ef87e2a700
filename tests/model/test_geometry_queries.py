"""Collisions and distance sensors in the Python module `fringe`: arrays in, tuples and dictionaries out, errors; and what `fringe sense`
prints."""


import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fringe
import numpy as np
import pytest

from tests import scenes
from tests.programs import fringe_command

CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
STEP = np.array([1.0, 0, 0])


def test_gjk_intersects_counts_touching() -> None:
    assert fringe.gjk_intersects(CUBE, CUBE + STEP) is True
    assert fringe.gjk_intersects(CUBE, CUBE + np.nextafter(1, 2) * STEP) is False
    assert fringe.gjk_intersects(CUBE.tolist(), [[0, 0, 0]]) is True


def test_gjk_distance_has_witnesses() -> None:
    distance, on_a, on_b = fringe.gjk_distance(CUBE, [[4.0, 0.25, 5.0]])
    assert distance == 5
    assert on_a.tolist() == [1, 0.25, 1]
    assert on_b.tolist() == [4, 0.25, 5]
    distance, on_a, on_b = fringe.gjk_distance(CUBE, CUBE + 0.5)
    assert distance == 0
    assert on_a.tolist() == on_b.tolist()


def test_bounding_sphere_and_aabb() -> None:
    centre, radius = fringe.bounding_sphere(CUBE)
    assert centre == pytest.approx([0.5, 0.5, 0.5], abs=1e-15)
    assert radius == pytest.approx(np.sqrt(0.75), rel=1e-14)
    assert (np.linalg.norm(CUBE - centre, axis=1) < radius).all()
    minimum, maximum = fringe.aabb(CUBE)
    assert minimum.tolist() == [0, 0, 0]
    assert maximum.tolist() == [1, 1, 1]


@pytest.mark.parametrize("method", ["vertices", "triangles", "tight"])
def test_obb_holds_every_vertex(method: str) -> None:
    centre, axes, half_widths = fringe.obb(CUBE, None, method)
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-15)
    assert np.linalg.det(axes) == pytest.approx(1)
    assert (np.abs((CUBE - centre) @ axes.T) < half_widths).all()


def test_obb_takes_faces() -> None:
    flat = np.array([[0, 0, 0], [4.0, 0, 0], [4, 1, 0], [0, 1, 0]])
    centre, axes, half_widths = fringe.obb(flat, np.array([[0, 1, 2], [0, 2, 3]]), "triangles")
    assert centre == pytest.approx([2, 0.5, 0])
    assert half_widths == pytest.approx([2, 0.5, 0], abs=1e-14)


@pytest.mark.parametrize(
    "call",
    [
        lambda: fringe.gjk_intersects(np.empty((0, 3)), CUBE),
        lambda: fringe.gjk_intersects(CUBE, CUBE[:, :2]),
        lambda: fringe.gjk_intersects(CUBE, CUBE, method="guess"),
        lambda: fringe.gjk_distance(CUBE, [[np.nan, 0, 0]]),
        lambda: fringe.bounding_sphere(np.empty((0, 3))),
        lambda: fringe.obb(CUBE, [[0, 1, -1]], "triangles"),
        lambda: fringe.obb(CUBE, None, "loose"),
    ],
)
def test_wrong_input_is_a_value_error(call) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(ValueError):
        call()


BODIES: dict[str, dict[str, Any]] = {"a": {"link": "arm"}, "b": {}, "c": {"translation": [5, 0, 0]}}


def test_answers_of_scene_collide_are_independent_of_each_other() -> None:
    """Dictionaries are given out again only when nobody holds them, and what was changed in them does not return."""
    cubes = [scenes.body(name, "cube", size=1, **keys) for name, keys in BODIES.items()]
    scene = fringe.Scene.loads(scenes.link("arm") + "".join(cubes))

    def statuses(answer: dict[str, Any]) -> list[str]:
        assert [(pair["a"], pair["b"]) for pair in answer["pairs"]] == [("a", "b"), ("a", "c"), ("b", "c")]
        assert set(answer) == {"tests", "pairs", "remarks"}
        return [pair["status"] for pair in answer["pairs"]]

    expected = {
        0.0: ["collision", "clear", "clear"],
        5.0: ["clear", "collision", "clear"],
        2.0: ["clear"] * 3,
    }
    kept = []
    for x in list(expected) * 4:
        scene.set_pose("arm", [x, 0, 0])
        answer = scene.collide()
        assert statuses(answer) == expected[x]
        kept.append((x, answer))
    assert all(statuses(answer) == expected[x] for x, answer in kept)

    del kept
    pair = scene.collide()["pairs"][0]
    spoils: list[Callable[[dict[str, Any]], object]] = [
        lambda answer: answer["pairs"].reverse(),
        lambda answer: answer["pairs"].pop(),
        lambda answer: answer["pairs"][1].clear(),
        lambda answer: answer["pairs"][1].update(status="mine", a="mine"),
        lambda answer: answer["pairs"][1].update(more=1),
        lambda answer: answer["pairs"].__setitem__(2, None),
        lambda answer: answer.clear(),
    ]
    for spoil in spoils:
        answer = scene.collide()
        spoil(answer)
        del answer
        for _ in range(3):
            assert statuses(scene.collide()) == expected[2.0]
    pair["status"] = "mine"
    assert statuses(scene.collide()) == expected[2.0] and pair["status"] == "mine"
    scene.hide("c")
    assert scene.collide()["pairs"] == [{"a": "a", "b": "b", "status": "clear"}]
    scene.show("c")
    assert statuses(scene.collide()) == expected[2.0]


METHODS = ["field_of_view", "cone_equation"]
ORIGIN, UP = np.zeros(3), np.array([0.0, 0, 1])
ABOVE = np.array([[-3.0, -3, 2], [3, -3, 2], [0, 3, 2]])
"""A triangle 2 above the origin, beyond which the cone goes straight through."""

SCENE = (
    scenes.link("arm", translation=[0, 0, 0.5])
    + scenes.eye("eye", [0, 0, 0], [0, 0, -2], 60, 0.8, link="arm")
    + scenes.eye("back", [0, 0, 0], [0, 0, 1], 180, 0.8, link="arm")
    + scenes.body("floor", "plate", size=[2, 2])
    + scenes.body(
        "water", "cube", size=0.1, translation=[0.1, 0, 0.1], material={"relative_permittivity": 80}
    )
)


@pytest.mark.parametrize("method", METHODS)
def test_cone_closest_gives_distance_point_and_triangle(method: str) -> None:
    triangles = np.stack([ABOVE + UP, ABOVE])
    distance, point, triangle = fringe.cone_closest(triangles, ORIGIN, 7 * UP, np.pi / 2, 10, method)
    assert (distance, point.tolist(), triangle) == (2, [0, 0, 2], 1)


@pytest.mark.parametrize("method", METHODS)
def test_cone_closest_is_none_when_nothing_is_in_the_cone(method: str) -> None:
    assert fringe.cone_closest([ABOVE], ORIGIN, -UP, np.pi, 10, method) is None
    assert fringe.cone_closest([ABOVE], ORIGIN, UP, np.pi, 1.999, method) is None
    assert fringe.cone_closest(np.empty((0, 3, 3)), ORIGIN, UP, np.pi, 10, method) is None


@pytest.mark.parametrize(
    "wrong",
    [
        {"triangles": ABOVE},
        {"apex": [0, 0]},
        {"direction": [0, 0, 0]},
        {"full_angle": 3.2},
        {"method": "field of view"},
    ],
    ids=str,
)
def test_cone_closest_refuses_wrong_input(wrong: dict[str, object]) -> None:
    right = {"triangles": [ABOVE], "apex": ORIGIN, "direction": UP, "full_angle": 1, "range": 1}
    with pytest.raises(ValueError):
        fringe.cone_closest(**{**right, **wrong})


@pytest.mark.parametrize("method", METHODS)
def test_sense_names_what_every_sensor_sees(method: str) -> None:
    scene = fringe.Scene.loads(SCENE)
    eye, back = scene.sense(method)["distance_sensors"]
    # The cube's top, 0.15 high, begins 5 cm beside the axis.
    assert (eye["name"], eye["object"]) == ("eye", "water")
    assert eye["distance"] == pytest.approx(np.hypot(0.05, 0.35), rel=1e-14)
    assert eye["point"] == pytest.approx([0.05, 0, 0.15], abs=1e-15)
    triangle = scene.conductors()["water"][eye["triangle"]]
    assert triangle[:, 2] == pytest.approx(np.full(3, 0.15), abs=1e-15)
    assert back == {"name": "back", "distance": None, "point": None, "object": None, "triangle": None}


@pytest.mark.parametrize("method", METHODS)
def test_sense_as_table(scene: Path, method: str) -> None:
    done = fringe_command("sense", scene, "--method", method)
    assert (done.returncode, done.stderr) == (0, "")
    _, _, eye, back = done.stdout.splitlines()
    assert eye.split()[:4] == ["eye", "353.553", "mm", "water,"]
    assert back.split() == ["back", "sees", "nothing"]


def test_a_scene_without_distance_sensors_has_no_readings(scene: Path) -> None:
    scene.write_text(scenes.body("floor", "plate", size=[2, 2]))
    assert json.loads(fringe_command("sense", scene, "--json").stdout) == {
        "format": 1,
        "distance_sensors": [],
        "remarks": [],
    }
    assert fringe_command("sense", scene).stdout == "the scene has no distance sensors\n"


def test_unknown_method_and_missing_file(scene: Path, tmp_path: Path) -> None:
    for arguments, reason in [
        ((scene, "--method", "echo"), 'unknown method "echo"'),
        ((tmp_path / "none.toml",), "the file does not exist"),
    ]:
        done = fringe_command("sense", *arguments)
        assert (done.returncode, done.stdout) == (2, "")
        assert reason in done.stderr
