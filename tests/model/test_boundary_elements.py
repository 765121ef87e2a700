"""Boundary elements and the reduced method from outside: set-ups known from another boundary-element method and from the field solver, the
command, the Python module."""

import json
import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.constants import epsilon_0
from scipy.special import elliprf

import fringe
from fem_reference.answer.reference import solve_conductors
from fem_reference.bodies.conductors import conductors
from geometries.scene import reader
from tests import scenes
from tests.programs import fringe_command


SET_UPS = json.loads(
    (
        Path(__file__).parents[2] / "analysis" / "topics" / "verification" / "boundary_elements.json"
    ).read_text()
)["cases"]

SCENE = (
    scenes.SENSOR
    + scenes.link("hand")
    + scenes.body("palm", "cuboid", size=[0.08, 0.1, 0.03], link="hand", translation=[0, 0, 0.05])
    + scenes.body("foil", "plate", size=[0.05, 0.05], translation=[0, 0, -0.02], potential="floating")
)


def scene_of(case: dict[str, Any]) -> str:
    """Every conductor as a sensor, which may have several plates."""
    plates: list[list[list[list[float]]]] = [[] for _ in case["conductors"]]
    for plate in case["rectangles"]:
        plates[plate["conductor"]].append([plate["corner"], plate["edge_u"], plate["edge_v"]])
    return "".join(scenes.sensor(name, *own) for name, own in zip(case["conductors"], plates, strict=True))


@cache
def solved(text: str, method: str, rtol: float) -> dict[str, Any]:
    return dict(fringe.Scene.loads(text).maxwell(method=method, rtol=rtol))


@pytest.mark.parametrize("case", SET_UPS, ids=lambda case: case["name"])
def test_plates_against_another_boundary_element_method(case: dict[str, Any]) -> None:
    truth = 1e-12 * np.array(case["maxwell_pF"])
    unsure = case["relative_error"] * np.abs(truth)
    for rtol in (1e-2, 1e-3, 1e-4):
        answer = solved(scene_of(case), "boundary-elements", rtol)
        assert answer["reached"] and np.all(answer["error"] <= rtol * np.abs(answer["maxwell"]))
        assert np.all(np.abs(answer["maxwell"] - truth) <= answer["error"] + unsure)
        # Galerkin's diagonal is a lower bound.
        assert all(answer["lower_bounds"])
        assert np.all(np.diag(answer["maxwell"]) <= np.diag(truth) + np.diag(unsure))


@pytest.mark.parametrize("case", SET_UPS, ids=lambda case: case["name"])
def test_the_reduced_method_against_another_boundary_element_method(case: dict[str, Any]) -> None:
    truth = 1e-12 * np.array(case["maxwell_pF"])
    unsure = case["relative_error"] * np.abs(truth)
    for rtol in (1e-2, 1e-3, 3e-4):
        answer = solved(scene_of(case), "reduced", rtol)
        difference = np.abs(answer["maxwell"] - truth)
        assert answer["rtol"] == rtol
        assert np.all(difference <= answer["error"] + unsure)
        if answer["reached"]:
            assert np.all(difference <= rtol * np.abs(truth) + unsure)


def stated_errors() -> dict[float, tuple[float, float]]:
    """What model/MEASUREMENTS.md states of the plates: median and worst error by rtol, in per cent."""
    text = (Path(__file__).parents[2] / "model" / "MEASUREMENTS.md").read_text()
    rows = text[text.index("| plates |") : text.index("| boxes |")].splitlines()
    cells = [[cell.strip() for cell in row.split("|")] for row in rows]
    errors = [row[3].split("/") for row in cells]
    return {float(row[2]): (float(pair[0]), float(pair[1])) for row, pair in zip(cells, errors)}


@pytest.mark.parametrize("rtol", [1e-2, 1e-3])
def test_the_errors_that_the_table_states(rtol: float) -> None:
    found = [solved(scene_of(case), "boundary-elements", rtol)["maxwell"] for case in SET_UPS]
    truths = [1e-12 * np.array(case["maxwell_pF"]) for case in SET_UPS]
    errors = sorted(100 * np.max(np.abs(own / truth - 1)) for own, truth in zip(found, truths))
    for measured, stated in zip((errors[len(errors) // 2], errors[-1]), stated_errors()[rtol]):
        # Two digits are stated.
        assert math.isclose(measured, stated, rel_tol=0.05)


def test_only_of_readings_an_accuracy_is_asked_without_more_words(scene: Path) -> None:
    asked = ("capacitance", scene, "--method", "boundary-elements", "--rtol", "1e-2")
    answer = json.loads(fringe_command(*asked, "--json").stdout)
    assert answer["options"] == {"method": "boundary-elements", "rtol": 1e-2}
    assert answer["reached"] and "rtol 0.01 reached in the readings" in fringe_command(*asked).stdout
    (reading,) = answer["readings"]
    assert reading["error"]["value"] <= 1e-2 * reading["value"]
    same = fringe.Scene.load(scene).readings("boundary-elements", rtol=1e-2)["front"]
    assert (same.value, same.change) == (reading["value"], reading["change"])


def test_the_table_for_people(scene: Path) -> None:
    done = fringe_command("capacitance", scene, "--method", "boundary-elements")
    assert done.returncode == 0
    for text in (
        "pF",
        "±",
        "rtol 0.01 reached in the readings",
        "delta_self",
        "floating, without charge",
        "foil",
    ):
        assert text in done.stdout


def test_an_error_that_is_not_reached_is_status_3_and_answered(tmp_path: Path) -> None:
    # The edges of a small plate stand six millimetres above the middle of the sensor: functions leave less than 1e-3, for which
    # triangles are not tried.
    path = tmp_path / "narrow.toml"
    path.write_text(
        SCENE.replace('"cuboid", size = [0.08, 0.1, 0.03]', '"plate", size = [0.02, 0.02]').replace(
            "translation = [0, 0, 0.05]", "translation = [0, 0, 0.006]"
        )
    )
    words = ("--method", "boundary-elements", "--rtol", "1e-5", "--entries", "--json")
    done = fringe_command("capacitance", path, *words)
    assert done.returncode == 3 and "was not reached" in done.stderr
    answer = json.loads(done.stdout)
    assert not answer["reached"]
    assert answer["error"][0][0] > 1e-5 * answer["maxwell"][0][0] > 0


def own_capacitance(shape: str, rtol: float = 1e-3) -> tuple[float, float]:
    """The capacitance (F) of one body and its error."""
    text = f'[[object]]\nname = "body"\npotential = "electrode"\nshape = {{ {shape} }}\n'
    answer = fringe.Scene.loads(text).maxwell(rtol=rtol)
    assert answer["reached"]
    return float(answer["maxwell"][0, 0]), float(answer["error"][0, 0])


BALL = 4 * math.pi * epsilon_0
"""Capacitance (F) of a ball of radius 1 m."""


@pytest.mark.parametrize(
    "shape, exact",
    [
        ('type = "ellipsoid", semi_axes = [1, 0.6, 0.3], segments = 16', BALL / elliprf(1, 0.36, 0.09)),
        ('type = "box", size = [2, 2, 2], rounding = 1, segments = 16', BALL),
    ],
)  # fmt: skip
def test_a_round_body_is_round_whatever_its_segments(shape: str, exact: float) -> None:
    value, error = own_capacitance(shape)
    assert abs(value - exact) <= error <= 1e-3 * value


def test_a_short_capsule_has_more_than_a_ball_and_less_than_a_larger_one() -> None:
    value, error = own_capacitance('type = "capsule", radius = 1, length = 0.01, segments = 16')
    assert BALL - error <= value <= 1.005 * BALL + error


def test_a_box_that_is_hardly_rounded_is_nearly_a_box() -> None:
    """One that is rounded lies within the box, and contains the inner box that the ball sweeps."""
    value, error = own_capacitance('type = "box", size = [1, 1, 1], rounding = 0.01, segments = 8')
    cube, unsure = own_capacitance('type = "cube", size = 1', 1e-4)
    smaller = 1 - 2 * 0.01
    assert smaller * cube - unsure - error <= value <= cube + unsure + error


def test_members_of_conductors_have_their_charges() -> None:
    text = scenes.sensor("front", [[-0.02, -0.02, 0], [0.04, 0, 0], [0, 0.04, 0]])
    for name, z in (("low", 0.03), ("high", 0.05)):
        text += scenes.body(name, "cube", size=0.02, translation=[0, 0, z])
    for name, x in (("left", -0.1), ("right", 0.1)):
        text += scenes.body(name, "cube", size=0.02, translation=[x, 0, 0.03], conductor="pair")
    answer = fringe.Scene.loads(text).maxwell(method="reduced", rtol=0.05)
    assert answer["conductors"] == ["front", "low", "pair"]
    assert answer["members"] == [["front"], ["low", "high"], ["left", "right"]]
    for row, charges in zip(answer["maxwell"], answer["charges"], strict=True):
        assert np.allclose(np.sum(charges, axis=0), row, rtol=1e-12, atol=0)
    low, high = answer["charges"][1][:, 0]
    assert low < high < 0, "the lower cube is nearer to the sensor"
    left, right = answer["charges"][2][:, 0]
    assert left == pytest.approx(right, rel=1e-3)


# Electrodes that are no rectangles, and no round bodies, so that both solve the same.
POLYGONS = (
    scenes.body(
        "electrode",
        "polygon",
        vertices=[[0, 0], [0.04, 0], [0.04, 0.04], [0.02, 0.04], [0.02, 0.02], [0, 0.02]],
        potential="electrode",
    )
    + scenes.body(
        "triangle",
        "polygon",
        vertices=[[0, 0], [0.03, 0.01], [-0.01, 0.03]],
        potential="electrode",
        translation=[-0.01, 0.03, 0.01],
    )
    + scenes.body("target", "box", size=[0.05, 0.04, 0.03], target=True, translation=[0.02, 0.02, 0.05])
)


@pytest.mark.night
def test_polygons_against_the_field_solver() -> None:
    boundary = fringe.Scene.loads(POLYGONS).maxwell(rtol=1e-2)
    field = solve_conductors(conductors(reader.loads(POLYGONS)), rtol=1e-2, error="estimate")
    apart = np.abs(boundary["maxwell"][:2, :2] - field.maxwell.value[:2, :2])
    assert np.all(apart <= boundary["error"][:2, :2] + field.maxwell.error[:2, :2])
    assert np.all(boundary["error"][:2, :2] <= 1e-2 * np.abs(boundary["maxwell"][:2, :2]))
