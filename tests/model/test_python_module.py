"""The Python module `fringe`: arrays in and out, the scene, the errors."""

import copy
import math
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import fringe

from tests import scenes
from tests.waiting import wait_until

CORNER, EDGE_U, EDGE_V = np.zeros(3), np.array([1.0, 0, 0]), np.array([0, 0.8, 0])
ABOVE = np.array([[0.1, 0.1, 0.5], [0.6, 0.1, 0.5], [0.1, 0.7, 0.5]])

SCENE = scenes.link("arm") + scenes.SENSOR + scenes.body("target", "plate", size=[0.1, 0.1], link="arm")


@pytest.fixture
def scene() -> fringe.Scene:
    return fringe.Scene.loads(SCENE)


def test_plate_integral_of_many_triangles() -> None:
    crossing = ABOVE - np.array([0, 0, 1]) * np.array([[0], [1], [0]])
    flat = np.array([ABOVE[0], ABOVE[0], ABOVE[1]])
    values = fringe.plate_integral(np.array([ABOVE, crossing, flat]), CORNER, EDGE_U, EDGE_V)
    assert values.dtype == np.float64
    assert values.shape == (3,)
    assert values[0] == pytest.approx(0.15 / 0.5, rel=1e-15)  # A / d
    assert values[1] == math.inf
    assert values[2] == 0


def test_plate_integral_takes_lists_integers_and_strided_arrays() -> None:
    expected = fringe.plate_integral(ABOVE[None], CORNER, EDGE_U, EDGE_V)
    assert fringe.plate_integral([ABOVE.tolist()], [0, 0, 0], [1, 0, 0], [0, 0.8, 0]) == expected
    assert (
        fringe.plate_integral(np.asfortranarray(np.array([ABOVE, ABOVE]))[::2], CORNER, EDGE_U, EDGE_V)
        == expected
    )


def test_plate_integral_of_no_triangles_is_empty() -> None:
    assert fringe.plate_integral(np.empty((0, 3, 3)), CORNER, EDGE_U, EDGE_V).shape == (0,)


@pytest.mark.parametrize(
    "change",
    [
        {"triangles": ABOVE},
        {"triangles": np.zeros((2, 3, 2))},
        {"triangles": np.full((1, 3, 3), np.inf)},
        {"corner": np.zeros(2)},
        {"edge_u": np.zeros((1, 3))},
        {"edge_v": np.array([1e-8, 0.8, 0])},
        {"method": "reduced"},
    ],
)
def test_plate_integral_refuses(change: dict[str, object]) -> None:
    arguments = {"triangles": ABOVE[None], "corner": CORNER, "edge_u": EDGE_U, "edge_v": EDGE_V} | change
    with pytest.raises(ValueError):
        fringe.plate_integral(**arguments)


def test_input_error_is_a_value_error() -> None:
    assert issubclass(fringe.InputError, ValueError)
    with pytest.raises(fringe.InputError, match="missing.toml"):
        fringe.Scene.load("missing.toml")


def test_conductors_are_in_the_world_frame_and_the_sensors_come_first(scene: fringe.Scene) -> None:
    scene.set_pose("arm", [0, 0, 0.02], np.eye(3))
    conductors = scene.conductors()
    assert list(conductors) == ["front", "target"]
    assert conductors["front"].shape == (2, 3, 3)
    np.testing.assert_array_equal(
        conductors["target"][1], [[-0.05, -0.05, 0.02], [0.05, 0.05, 0.02], [-0.05, 0.05, 0.02]]
    )


def test_remarks_are_in_the_answers_and_those_on_the_present_poses_at_hand(tmp_path: Path) -> None:
    text = (
        scenes.link("arm")
        + scenes.sensor("front", [[0, 0, -1], [0.1, 0, 0], [0, 0.1, 0]])
        + scenes.body("box", "cube", size=1)
        + scenes.body("hand", "sphere", radius=0.1, segments=8, link="arm")
    )
    scene = fringe.Scene.loads(text)
    (remark,) = scene.remarks
    assert remark.startswith('object "box" contains "hand": ')
    for answer in (
        scene.capacitance(),
        scene.maxwell(rtol=0.1),
        scene.collide(),
        scene.sense(),
        scene.info(),
    ):
        assert remark in answer["remarks"]
    assert len(scene.capacitance()["remarks"]) == 2, "the box is in between, too"
    scene.set_pose("arm", [0, 0, 2])
    assert scene.remarks == []


def test_set_pose_takes_a_matrix_or_a_quaternion(scene: fringe.Scene) -> None:
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    scene.set_pose("arm", [1, 2, 3], turn)
    by_matrix = scene.conductors()["target"]
    np.testing.assert_allclose(by_matrix[0, 0], [1.05, 1.95, 3], atol=1e-15)
    scene.set_pose("arm", [1, 2, 3], [3, 0, 0, 3])
    np.testing.assert_allclose(scene.conductors()["target"], by_matrix, atol=1e-15)


def test_set_pose_takes_a_whole_pose_and_keeps_a_rotation_that_is_left_out(scene: fringe.Scene) -> None:
    pose = np.array([[0.0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]])
    scene.set_pose("arm", pose)
    np.testing.assert_array_equal(scene.pose("arm"), pose)
    scene.set_pose("arm", [4, 5, 6])
    np.testing.assert_array_equal(scene.pose("arm")[:3, :3], pose[:3, :3])
    np.testing.assert_array_equal(scene.pose("arm")[:3, 3], [4, 5, 6])


def test_a_scene_is_made_from_text_with_its_meshes_in_a_folder(tmp_path: Path) -> None:
    (tmp_path / "sheet.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    text = '[[object]]\nname = "sheet"\nshape = { type = "mesh", file = "sheet.obj" }\n'
    assert fringe.Scene.loads(text, tmp_path).objects == ["sheet"]
    with pytest.raises(fringe.InputError, match='^scene:3: object "sheet": shape.file: '):
        fringe.Scene.loads(text, tmp_path / "nowhere")
    with pytest.raises(fringe.InputError, match="^scene:1: "):
        fringe.Scene.loads("[[object")


def test_a_scene_tells_its_names_and_what_it_holds(scene: fringe.Scene) -> None:
    assert (scene.links, scene.sensors, scene.objects, scene.joints) == (["arm"], ["front"], ["target"], [])
    assert repr(scene) == "<fringe.Scene of 1 links, 1 sensors, 1 objects, 0 readings>"
    jointed = SCENE.replace(
        'name = "arm"', 'name = "arm"\njoint = { name = "lift", type = "prismatic", axis = [0, 0, 1] }'
    )
    assert fringe.Scene.loads(jointed).joints == ["lift"]


@pytest.mark.parametrize("copied", [lambda scene: scene.copy(), copy.copy, copy.deepcopy])
def test_a_copy_moves_by_itself(scene: fringe.Scene, copied: Callable[[fringe.Scene], fringe.Scene]) -> None:
    scene.set_pose("arm", [0, 0, 0.02])
    other = copied(scene)
    other.set_pose("arm", [0, 0, 0.03])
    assert scene.pose("arm")[2, 3] == 0.02
    expected = fringe.Scene.loads(SCENE)
    expected.set_pose("arm", [0, 0, 0.03])
    assert other.capacitance()["sensors"] == expected.capacitance()["sensors"]


@pytest.mark.parametrize(
    ("link", "arguments"),
    [
        ("leg", ([0, 0, 0],)),
        ("arm", ([0, 0],)),
        ("arm", ([0, 0, math.nan],)),
        ("arm", ([0, 0, 0], [0, 0, 0, 0])),
        ("arm", ([0, 0, 0], [1, 0, 0])),
        ("arm", ([0, 0, 0], 2 * np.eye(3))),
        ("arm", (np.eye(4), np.eye(3))),
        ("arm", (2 * np.eye(4),)),
        ("arm", (np.diag([2.0, 1, 1, 1]),)),
    ],
)
def test_set_pose_refuses(scene: fringe.Scene, link: str, arguments: tuple[object, ...]) -> None:
    with pytest.raises(fringe.InputError):
        scene.set_pose(link, *arguments)
    np.testing.assert_array_equal(scene.pose("arm"), np.eye(4))


def test_other_threads_run_while_the_integral_is_computed() -> None:
    ticks = 0
    stop = threading.Event()

    def count() -> None:
        nonlocal ticks
        while not stop.wait(0.001):
            ticks += 1

    def counts_meanwhile() -> bool:
        """One or two ticks may fall between the call and the reading of the counter."""
        before = ticks
        fringe.plate_integral(np.repeat(ABOVE[None], 200, axis=0), CORNER, EDGE_U, EDGE_V, method="split:8")
        return ticks > before + 3

    counter = threading.Thread(target=count)
    counter.start()
    try:
        # A busy machine may let the counter wait during the whole of a call.
        wait_until(counts_meanwhile, "a thread that goes on while another computes")
    finally:
        stop.set()
        counter.join()
