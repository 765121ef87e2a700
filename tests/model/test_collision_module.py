"""The collision functions of the Python module `fringe`: shapes of arrays, tuples, errors."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fringe

CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
STEP = np.array([1.0, 0, 0])
METHODS = ["vertices", "triangles", "tight"]


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


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    "vertices", [CUBE, CUBE[:1], CUBE[:2], CUBE[:4]], ids=["cube", "point", "segment", "flat"]
)
def test_obb_holds_every_vertex(vertices: np.ndarray, method: str) -> None:
    centre, axes, half_widths = fringe.obb(vertices, None, method)
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-15)
    assert np.linalg.det(axes) == pytest.approx(1)
    assert (np.abs((vertices - centre) @ axes.T) < half_widths).all()


def test_obb_takes_faces() -> None:
    flat = np.array([[0, 0, 0], [4.0, 0, 0], [4, 1, 0], [0, 1, 0]])
    centre, axes, half_widths = fringe.obb(flat, np.array([[0, 1, 2], [0, 2, 3]]), "triangles")
    assert centre == pytest.approx([2, 0.5, 0])
    assert half_widths == pytest.approx([2, 0.5, 0], abs=1e-14)


def test_scene_collide_follows_its_links(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(
        'link = [ { name = "arm" } ]\n'
        '[[object]]\nname = "a"\nlink = "arm"\nshape = { type = "sphere", radius = 1, segments = 12 }\n'
        '[[object]]\nname = "b"\nshape = { type = "cube", size = 2 }\n'
    )
    scene = fringe.Scene.load(path)
    for x, status in ((1.5, "collision"), (2.5, "clear"), (2.0, "collision")):
        scene.set_pose("arm", [x, 0, 0], np.eye(3))
        answer = scene.collide()
        assert answer["pairs"] == [{"a": "a", "b": "b", "status": status}]
    scene.set_pose("arm", [1.9, 1.9, 0], np.eye(3))
    assert scene.collide()["pairs"][0]["status"] == "bounds"
    assert scene.collide()["tests"] == {"broad": 0, "narrow": 0}


@pytest.mark.parametrize(
    "call",
    [
        lambda: fringe.gjk_intersects(np.empty((0, 3)), CUBE),
        lambda: fringe.gjk_intersects(CUBE, CUBE[:, :2]),
        lambda: fringe.gjk_intersects(CUBE, CUBE, method="guess"),
        lambda: fringe.gjk_distance(CUBE, [[np.nan, 0, 0]]),
        lambda: fringe.bounding_sphere(np.empty((0, 3))),
        lambda: fringe.aabb([[np.inf, 0, 0]]),
        lambda: fringe.obb(CUBE, [[0, 1, 8]], "triangles"),
        lambda: fringe.obb(CUBE, [[0, 1, -1]], "triangles"),
        lambda: fringe.obb(CUBE, None, "loose"),
    ],
)
def test_wrong_input_is_a_value_error(call) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(ValueError):
        call()


def test_answers_of_scene_collide_are_independent_of_each_other(tmp_path: Path) -> None:
    """Dictionaries are given out again only when nobody holds them, and what was changed in them does not return."""
    path = tmp_path / "scene.toml"
    cube = 'shape = { type = "cube", size = 1 }'
    path.write_text(
        'link = [ { name = "arm" } ]\n'
        f'[[object]]\nname = "a"\nlink = "arm"\n{cube}\n'
        f'[[object]]\nname = "b"\n{cube}\n'
        f'[[object]]\nname = "c"\n{cube}\ntranslation = [5, 0, 0]\n'
    )
    scene = fringe.Scene.load(path)

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
