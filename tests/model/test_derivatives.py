"""Derivatives of readings with respect to the poses of links, as Python and the command give them."""

import json
from pathlib import Path
from typing import Any

import fringe
import numpy as np
import pytest

from tests import scenes
from tests.end_to_end.importing import about
from tests.programs import fringe_command
from tests.waiting import DEADLINE

ARM = (
    scenes.link("arm", translation=[0.1, 0.05, 0.2], rotation={"axis": [1, 2, 3], "degrees": 40})
    + scenes.link(
        "wrist",
        parent="arm",
        joint={"name": "turn", "type": "revolute", "axis": [0, 1, 0]},
        translation=[0.15, 0.02, 0.03],
        rotation={"axis": [0, 1, 1], "degrees": 25},
    )
    + scenes.link("hand", translation=[0.25, 0.15, 0.45])
    + scenes.sensor(
        "front",
        [[0, 0, 0], [0.05, 0, 0], [0, 0.04, 0]],
        [[0.05, 0, 0], [0.05, 0, 0], [0, 0.04, 0]],
        link="wrist",
    )
    + scenes.body("palm", "box", size=[0.1, 0.08, 0.03], link="hand", target=True)
    + scenes.body("forearm", "box", size=[0.05, 0.05, 0.1], link="arm", target=True)
    + scenes.body("wall", "box", size=[1, 1, 0.1], target=True)
    + scenes.body("rest", "box", size=[0.02, 0.02, 0.02], link="hand")
)
LINKS = ("arm", "wrist", "hand")


def slope(
    scene: Any, link: str, coordinate: int, step: float, method: str, **options: Any
) -> dict[str, float]:
    """The central differences of the changes of all readings along, or about, an axis of the world; the link returns."""
    pose = scene.pose(link)
    parent = np.array(scene.pose("arm")[:3, :3]) if link == "wrist" else np.eye(3)
    ends = []
    for amount in (step, -step):
        shift, rotation = np.zeros(3), pose[:3, :3]
        if coordinate < 3:
            shift[coordinate] = amount
        else:
            rotation = parent.T @ about(coordinate - 3, amount) @ parent @ rotation
        scene.set_pose(link, pose[:3, 3] + parent.T @ shift, rotation)
        ends.append(scene.readings(method, **options))
    scene.set_pose(link, pose)
    return {name: (ends[0][name].change - ends[1][name].change) / (2 * step) for name in ends[0]}


@pytest.mark.parametrize("method", ["exact", "exact+facing", "exact+nearest", "exact+nearest+facing"])
def test_they_are_the_central_differences_of_the_change(method: str) -> None:
    scene = fringe.Scene.loads(ARM)
    reading = scene.readings(method, derivatives=True)["front"]
    assert sorted(reading.derivatives) == sorted(LINKS)
    for link in LINKS:
        expected = np.array([slope(scene, link, k, 1e-5, method)["front"] for k in range(6)])
        assert np.abs(reading.derivatives[link] - expected).max() < 1e-5 * np.abs(expected).max()
        assert reading.derivative_errors[link] is None


def test_they_do_not_depend_on_the_tolerance_of_the_value() -> None:
    scene = fringe.Scene.loads(ARM)
    exact, rough = (
        scene.capacitance("exact", derivatives=True, tolerance=t)["readings"][0] for t in (0, 0.1)
    )
    for link in LINKS:
        assert rough["derivatives"][link] == pytest.approx(exact["derivatives"][link], rel=1e-12)


def test_they_follow_the_links() -> None:
    scene = fringe.Scene.loads(ARM)
    scene.readings("exact", derivatives=True)
    pose = scene.pose("hand")
    for shift in (0.01, 0.02):
        scene.set_pose("hand", pose[:3, 3] + [shift, 0, 0])
        moved = scene.readings("exact", derivatives=True)["front"].derivatives
    fresh = fringe.Scene.loads(ARM)
    fresh.set_pose("hand", pose[:3, 3] + [0.02, 0, 0])
    expected = fresh.readings("exact", derivatives=True)["front"].derivatives
    for link in LINKS:
        assert moved[link] == pytest.approx(expected[link], rel=1e-12)


def test_they_are_not_a_number_in_contact() -> None:
    scene = fringe.Scene.loads(ARM)
    pose = np.eye(4)
    pose[:3, :3] = scene.pose("arm")[:3, :3] @ scene.pose("wrist")[:3, :3]
    pose[:3, 3] = scene.pose("arm")[:3, :3] @ scene.pose("wrist")[:3, 3] + scene.pose("arm")[:3, 3]
    scene.set_pose("hand", pose)
    reading = scene.readings("exact", derivatives=True)["front"]
    assert reading.change == np.inf
    assert np.isnan(reading.derivatives["hand"]).all()
    remarks = scene.capacitance(derivatives=True)["remarks"]
    assert 'reading "front": in contact its derivatives are not known' in remarks


def test_without_the_question_there_are_none() -> None:
    reading = fringe.Scene.loads(ARM).readings("exact")["front"]
    assert reading.derivatives == {} and reading.derivative_errors == {}


@pytest.mark.parametrize("method", ["split:3", "gauss:4", "formula"])
def test_methods_without_derivatives_refuse_them(method: str) -> None:
    scene = fringe.Scene.loads(ARM)
    with pytest.raises(fringe.InputError, match=f"derivatives is no option of {method}: exact, reduced"):
        scene.readings(method, derivatives=True)


MACHINE = (
    scenes.link("head")
    + scenes.link("hand", translation=[0.02, 0.01, 0.05], rotation={"axis": [1, 2, 0], "degrees": 20})
    + scenes.sensor("front", [[-0.03, -0.02, 0], [0.06, 0, 0], [0, 0.04, 0]], link="head")
    + scenes.body(
        "guard", "plate", size=[0.1, 0.08], link="head", translation=[0, 0, -0.01], potential="electrode"
    )
    + scenes.body("housing", "box", size=[0.12, 0.12, 0.05], translation=[0, 0, -0.06])
    + scenes.body("palm", "box", size=[0.08, 0.09, 0.02], link="hand", target=True)
    + scenes.table("reading", name="self", sense="front", drive=["front"])
    + scenes.table("reading", name="transmitted", sense="front", drive=["guard"])
)


def test_by_boundary_elements_they_are_those_of_accurate_changes() -> None:
    scene = fringe.Scene.loads(MACHINE)
    readings = scene.readings("boundary-elements", rtol=1e-3, derivatives=True)
    for link in ("head", "hand"):
        for coordinate, step in ((0, 2e-3), (2, 2e-3), (4, 3e-2)):
            expected = slope(scene, link, coordinate, step, "boundary-elements", rtol=1e-4)
            for name, reading in readings.items():
                found, error = reading.derivatives[link], reading.derivative_errors[link][coordinate]
                kind = found[:3] if coordinate < 3 else found[3:]
                assert error < 0.05 * np.linalg.norm(kind)
                assert abs(found[coordinate] - expected[name]) < error + 5e-3 * np.linalg.norm(kind)


BALL = (
    scenes.link("w", translation=[0.02, 0.01, 0.06])
    + scenes.sensor("s", [[-0.05, -0.05, 0], [0.1, 0, 0], [0, 0.1, 0]])
    + scenes.body("ball", "sphere", radius=0.04, link="w", target=True)
)


@pytest.mark.parametrize("method", ["boundary-elements", "reduced"])
def test_a_ball_feels_no_torque_about_its_centre_within_the_error(method: str) -> None:
    reading = fringe.Scene.loads(BALL).readings(method, rtol=1e-2, derivatives=True)["s"]
    found, error = reading.derivatives["w"], reading.derivative_errors["w"]
    assert (np.abs(found[3:]) < error[3:]).all()
    # Far less than the forces at the ball's radius.
    assert error[3] < 0.02 * 0.04 * np.linalg.norm(found[:3])


@pytest.mark.night
def test_the_reduced_method_knows_them_without_marked_targets_and_beside_round_bodies() -> None:
    bare = MACHINE[: MACHINE.index("[[object]]")]
    text = bare + scenes.body("ball", "sphere", radius=0.03, segments=12, link="hand")
    marked, unmarked = (fringe.Scene.loads(text + more) for more in ("target = true", ""))
    expected = marked.readings("boundary-elements", rtol=5e-3, derivatives=True)["front"].derivatives["hand"]
    for scene in (marked, unmarked):
        assert scene.readings("reduced", entries=True)["front"].derivatives == {}
        found = scene.readings("reduced", entries=True, derivatives=True)["front"]
        # The matrix is that of the polyhedron, which changes the reading by 6 % less than the ball.
        error = found.derivative_errors["hand"][0]
        assert np.linalg.norm(found.derivatives["hand"][:3] - expected[:3]) < error
        assert error < 0.9 * np.linalg.norm(expected[:3])


TOUCHING = (
    scenes.link("head")
    + scenes.link("hand", translation=[0, 0, 0.2])
    + scenes.sensor("front", [[0, 0, 0.05], [0.05, 0, 0], [0, 0.05, 0]], link="head")
    + scenes.body("base", "box", size=[0.1, 0.1, 0.1], translation=[0, 0, -0.08])
    + scenes.body("neck", "box", size=[0.1, 0.1, 0.05], link="head", translation=[0, 0, -0.005])
    + scenes.body("palm", "plate", size=[0.1, 0.1], link="hand", target=True)
)


def test_they_are_not_known_between_links_that_touch() -> None:
    scene = fringe.Scene.loads(TOUCHING)
    reading = scene.readings("boundary-elements", rtol=0.2, derivatives=True)["front"]
    assert np.isnan(reading.derivatives["head"]).all()
    assert reading.derivatives["hand"][2] < 0


def test_those_of_a_body_apart_do_not_wait_for_links_that_overlap() -> None:
    """Between two links of one potential that overlap, nodes would have to be ever closer together."""
    round_ones = TOUCHING.replace(
        'type = "box", size = [0.1, 0.1, 0.1]', 'type = "sphere", radius = 0.06, segments = 32'
    ).replace('type = "box", size = [0.1, 0.1, 0.05]', 'type = "sphere", radius = 0.05, segments = 32')
    apart, as_one = (
        fringe.Scene.loads(text).readings(
            "boundary-elements", rtol=0.05, derivatives=True, max_seconds=DEADLINE
        )["front"]
        for text in (round_ones, round_ones.replace('name = "base"', 'name = "base"\nlink = "head"'))
    )
    assert np.isnan(apart.derivatives["head"]).all()
    np.testing.assert_allclose(
        apart.derivatives["hand"][:3], as_one.derivatives["hand"][:3], rtol=2e-2, atol=1e-14
    )


def test_none_are_told_of_a_change_that_the_reduced_method_cannot_find() -> None:
    # At this accuracy the charges of links that touch lie in each other, and their equations have no solution.
    reading = fringe.Scene.loads(TOUCHING).readings("reduced", rtol=0.2, derivatives=True)["front"]
    assert reading.change is None and not reading.derivatives


def test_the_command_prints_them(tmp_path: Path) -> None:
    (tmp_path / "arm.toml").write_text(ARM)
    words = ("capacitance", tmp_path / "arm.toml", "--derivatives")
    table, document = (fringe_command(*words, *more).stdout for more in ((), ("--json",)))
    described = json.loads(document)["readings"][0]
    expected = fringe.Scene.loads(ARM).readings("exact", derivatives=True)["front"].derivatives
    for link in LINKS:
        assert described["derivatives"][link] == list(expected[link])
        assert described["derivative_errors"][link] is None
    assert [line.split()[1] for line in table.split("Derivatives")[1].splitlines()[1:]] == list(LINKS)


def test_those_of_single_triangles() -> None:
    triangle = np.array([[0.2, 0.2, 0.1], [0.8, 0.2, 0.1], [0.2, 0.6, 0.1]])
    found = fringe.plate_integral_derivatives([triangle], [0, 0, 0], [1, 0, 0], [0, 0.8, 0])
    assert found.shape == (1, 6)
    force = np.array([0, 0, -0.12 / 0.01])
    assert found[0] == pytest.approx([*force, *np.cross(triangle.mean(axis=0), force)], rel=1e-12)
    with pytest.raises(fringe.InputError, match="triangle 0: vertex 1 is not finite"):
        fringe.plate_integral_derivatives(
            [triangle * [[1], [np.inf], [1]]], [0, 0, 0], [1, 0, 0], [0, 0.8, 0]
        )
