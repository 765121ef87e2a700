"""What a set-up looks like in numbers, and which set-ups must have equal answers."""

import math
from pathlib import Path

import numpy as np
import pytest

from analysis.results import set_up, study_results as results, symmetry
from geometries.scene.scene import Scene
from geometries.studies import families
from tests import scenes
from tests.analysis.documents import model_document, reference_document
from tests.analysis.synthetic import EDGE, PARALLEL, make_results

SENSOR = (0.1, 0.1)


def described(scene: Scene) -> set_up.SetUp:
    found = set_up.describe(scene)
    assert found is not None
    return found


def test_parallel_plates() -> None:
    found = described(families.parallel(SENSOR, (0.2, 0.2), 0.013, offset=(0.03, 0.04)))
    assert found.gap == pytest.approx(0.013)
    assert found.tilt_degrees == pytest.approx(0, abs=1e-6)
    assert found.lateral_offset_over_size == pytest.approx(0.5)
    assert found.size_ratio == pytest.approx(2)


@pytest.mark.parametrize(
    ("scene", "gap"),
    [
        *((families.inclined(SENSOR, SENSOR, 0.013, tilt), 0.013) for tilt in (2.0, 17.2, 90.0)),
        (families.edge(SENSOR, SENSOR, 0.03, 0.04, 45.0), 0.05),
        (families.corner(SENSOR, SENSOR, (0.02, 0.03), 0.06), 0.07),
        # An upright plate turned across the sensor's edge: the nearest points lie inside both edges.
        (families.straddle(SENSOR, (0.02, 0.1), 0.013, (0.05, 0.0), 90.0, 90.0), 0.013),
    ],
    ids=["hinge 2°", "hinge 17.2°", "hinge 90°", "beside an edge", "off a corner", "crossing edges"],
)
def test_the_gap_is_between_the_nearest_points(scene: Scene, gap: float) -> None:
    assert described(scene).gap == pytest.approx(gap)


def test_the_tilt_is_between_the_planes() -> None:
    assert described(families.inclined(SENSOR, SENSOR, 0.013, 17.2)).tilt_degrees == pytest.approx(17.2)


def test_a_scene_that_is_not_two_plates_has_no_such_numbers() -> None:
    assert set_up.describe(families.empty(SENSOR)) is None


def plates(scene: Scene) -> tuple[set_up.Rectangle, set_up.Rectangle]:
    found = set_up.rectangles(scene)
    assert found is not None
    return found


def test_rectangles_are_the_conductors_of_the_scene() -> None:
    scene = families.corner(SENSOR, (0.05, 0.07), (0.01, 0.02), 0.01, 17.2, 33.0)
    sensor, target = plates(scene)
    for rectangle, name in ((sensor, "sensor"), (target, "target")):
        vertices = np.unique(np.round(scene.conductors()[name].reshape(-1, 3), 12), axis=0)
        np.testing.assert_allclose(np.unique(np.round(rectangle.vertices, 12), axis=0), vertices)


def relations(tmp_path: Path, sweeps: str) -> list[tuple[str, str]]:
    found = symmetry.pairs(results.load(make_results(tmp_path, sweeps)).compared())
    return [(pair.relation, pair.quantity) for pair in found]


STRADDLE = scenes.sweep("straddle", gap=0.02)
MIRRORED = [("mirrored or moved", "mutual"), ("mirrored or moved", "delta_self")]
EXCHANGED = [("sensor and target exchanged", "mutual")]


def test_mirror_images_must_agree_in_both_quantities(tmp_path: Path) -> None:
    assert relations(tmp_path, STRADDLE + "offset = [[0.06, 0], [-0.06, 0]]") == MIRRORED


def test_one_set_up_reached_through_two_families_must_agree(tmp_path: Path) -> None:
    inclined = (
        PARALLEL.replace("parallel", "inclined")
        .replace("gap = [0.01, 0.02, 0.04]", "hinge_gap = 0.02\ntilt_degrees = 60")
        .replace("target_size = [0.1, 0.1]", "target_size = [0.2, 0.2]")
    )
    mirrored = STRADDLE.replace("target_size = [0.1, 0.1]", "target_size = [0.2, 0.2]")
    mirrored += "offset = [0, 0]\ntilt_degrees = 60\nturn_degrees = 180\n"
    assert relations(tmp_path, inclined + mirrored) == MIRRORED


def test_sensor_and_target_exchanged_must_agree_in_mutual(tmp_path: Path) -> None:
    plates_exchanged = PARALLEL.replace("[0.01, 0.02, 0.04]", "0.02").replace(
        "target_size = [0.1, 0.1]", "target_size = [0.1, 0.3]"
    )
    other = plates_exchanged.replace("sensor_size = [0.1, 0.1]", "sensor_size = [0.1, 0.3]").replace(
        "target_size = [0.1, 0.3]", "target_size = [0.1, 0.1]"
    )
    assert relations(tmp_path, plates_exchanged + other) == EXCHANGED


def test_different_set_ups_need_not_agree(tmp_path: Path) -> None:
    assert relations(tmp_path, PARALLEL + EDGE) == []


@pytest.mark.parametrize(("other", "agrees"), [(2.015, True), (2.03, False)])
def test_a_pair_agrees_when_the_difference_is_within_the_sum_of_the_errors(
    tmp_path: Path, other: float, agrees: bool
) -> None:
    answers = {
        0: (reference_document(2, 1, error=0.01), model_document(1)),
        1: (reference_document(other, 1, error=0.01), model_document(1)),
    }
    folder = make_results(tmp_path, STRADDLE + "offset = [[0.06, 0], [-0.06, 0]]", answers)
    mutual = symmetry.pairs(results.load(folder).compared())[0]
    assert mutual.agrees is agrees
    assert mutual.difference == pytest.approx((other - 2) / ((other + 2) / 2))
    assert math.isclose(mutual.first_value.value, 2e-12)
