"""Experiments I to IV: splitting, delta output as the thesis defines it, its error bar, and the curves that a study's answers make."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analysis.results import study_results as results
from analysis.results.answers import Estimate
from analysis.results.set_up import rectangles
from analysis.topics.experiments.curves import Divider, curves, reference_delta_output, with_flat_start
from analysis.topics.experiments.section import (
    AT_CORNER,
    BESIDE_EDGE,
    IN_FRONT,
    SEVERAL,
    accuracies,
    region,
    splitting_finding,
)
from geometries.scene.scene import Scene
from geometries.studies import families
from tests import scenes
from tests.analysis.synthetic import EDGE, PARALLEL, PICO, make_results, model_document, reference_document

SIZE = (0.1, 0.06)


@pytest.mark.parametrize(
    "scene, expected",
    [
        (families.parallel(SIZE, SIZE, 0.01), IN_FRONT),
        (families.parallel(SIZE, (0.101, 0.06), 0.01), SEVERAL),
        (families.inclined(SIZE, SIZE, 0.01, 30), IN_FRONT),
        (families.inclined(SIZE, SIZE, 0.01, 90), IN_FRONT),
        (families.edge(SIZE, SIZE, 0.01, 0), BESIDE_EDGE),
        (families.edge(SIZE, SIZE, 0, 0.01, 45), BESIDE_EDGE),
        (families.corner(SIZE, SIZE, (0.01, 0.02), 0), AT_CORNER),
        (families.corner(SIZE, SIZE, (0, 0), 0.01, 20, 30), AT_CORNER),
        (families.straddle(SIZE, SIZE, 0.01, (0.02, 0)), SEVERAL),
        (families.straddle(SIZE, SIZE, 0.01, (0.05, 0.03)), SEVERAL),
    ],
)
def test_regions_as_seen_along_the_normal(scene: Scene, expected: str) -> None:
    plates = rectangles(scene)
    assert plates is not None
    assert region(*plates) == expected


def test_errors_by_region_and_level_computed_by_hand(tmp_path: Path) -> None:
    answers = {
        number: (None, model_document(2, coarse=coarse)) for number, coarse in enumerate([1, 1.5, 1.8, 3, 2])
    }
    found = accuracies(results.load(make_results(tmp_path, PARALLEL + EDGE, answers)))
    assert [(each.region, each.level) for each in found] == [
        (IN_FRONT, 0),
        (IN_FRONT, 4),
        (BESIDE_EDGE, 0),
        (BESIDE_EDGE, 4),
    ]
    assert found[0].errors == pytest.approx((-0.5, -0.25, -0.1))
    assert (found[0].median, found[0].worst) == pytest.approx((0.25, 0.5))
    assert found[1].worst == pytest.approx(1e-5)
    assert found[2].errors == pytest.approx((0.5, 0))


def test_the_finding_is_of_the_level_that_the_thesis_recommends(tmp_path: Path) -> None:
    answers = {number: (None, model_document(2, coarse=1)) for number in range(5)}
    text = splitting_finding(accuracies(results.load(make_results(tmp_path, PARALLEL + EDGE, answers))))
    assert (
        text.startswith("After 4 splits")
        and "region I 0.001 % (0.001 %), region II 0.001 % (0.001 %)" in text
    )
    assert "below the exact integral in 50 % of all" in text


OVER_DISTANCE = scenes.sweep("parallel", target_size=[[0.1, 0.1], [0.05, 0.05]], gap=[0.04, 0.01])
INCLINED = scenes.sweep("inclined", hinge_gap=0.01, tilt_degrees=[30, 60])


def test_delta_output_is_the_output_without_objects_less_that_with_them() -> None:
    alone = Divider(coupling=5 * PICO, own=0, voltage=2.5)
    assert alone.delta_output(np.array([0.0, 5 * PICO])) == pytest.approx([0, 2.5 - 1.25])
    beside = Divider(coupling=5 * PICO, own=5 * PICO, voltage=2.5)
    change = np.array([10 * PICO, 30 * PICO])
    assert beside.delta_output(change) == pytest.approx([1.25 - 0.625, 1.25 - 0.3125])


def test_what_the_reference_may_be_off_moves_the_delta_output_by_its_error_bar() -> None:
    own, change = Estimate(4 * PICO, 1e-4 * PICO), Estimate(3 * PICO, 2e-4 * PICO)
    found = reference_delta_output(own, change, 5 * PICO, 2.5)

    def moved(by_own: float, by_change: float) -> float:
        divider = Divider(5 * PICO, own.value + by_own * own.error, 2.5)
        return float(divider.delta_output(np.array([change.value + by_change * change.error]))[0])

    corners = [abs(moved(s, t) - found.value) for s in (-1, 1) for t in (-1, 1)]
    assert max(corners) == pytest.approx(found.error, rel=1e-3)


def test_a_curve_for_each_plate_in_the_order_of_the_study_and_of_the_distance(tmp_path: Path) -> None:
    found = curves(results.load(make_results(tmp_path, OVER_DISTANCE + INCLINED + EDGE)))
    assert [(curve.family, curve.target_size, curve.at.tolist()) for curve in found] == [
        ("parallel", (0.1, 0.1), [0.01, 0.04]),
        ("parallel", (0.05, 0.05), [0.01, 0.04]),
        ("inclined", (0.1, 0.1), [30, 60]),
    ]
    first = found[0]
    assert (first.coupling, first.voltage, first.own.value) == pytest.approx((5e-12, 2.5, 4e-12))
    assert first.model == pytest.approx([1.8e-12] * 2)
    assert first.reference == pytest.approx(Divider(5e-12, 4e-12, 2.5).delta_output(np.full(2, 1e-12)))


def test_cases_without_both_answers_are_left_out(tmp_path: Path) -> None:
    answers = {0: (None, model_document(1)), 1: (reference_document(2, 1), None)}
    found = curves(results.load(make_results(tmp_path, OVER_DISTANCE, answers)))
    assert [curve.target_size for curve in found] == [(0.05, 0.05)]


def test_floating_targets_have_no_mutual_and_are_left_out(tmp_path: Path) -> None:
    floating = reference_document(2, 1, conductors=["sensor"])
    answers = {place: (floating, model_document(1)) for place in range(2)}
    found = curves(results.load(make_results(tmp_path, OVER_DISTANCE, answers)))
    assert [curve.target_size for curve in found] == [(0.05, 0.05)]


def test_the_parallel_plate_at_the_height_of_the_hinge_is_the_angle_0(tmp_path: Path) -> None:
    flat, small, pivoted = curves(results.load(make_results(tmp_path, OVER_DISTANCE + INCLINED)))
    whole = with_flat_start(pivoted, flat)
    assert whole.at.tolist() == [0, 30, 60]
    assert whole.points[0].case == flat.points[0].case
    assert with_flat_start(pivoted, small).at.tolist() == [30, 60]
    elsewhere = replace(flat, points=flat.points[1:])
    assert with_flat_start(pivoted, elsewhere).at.tolist() == [30, 60]


def test_a_plate_hinged_to_the_edge_of_a_wider_sensor_is_not_the_centred_one(tmp_path: Path) -> None:
    wide = (OVER_DISTANCE + INCLINED).replace("sensor_size = [0.1, 0.1]", "sensor_size = [0.2, 0.1]")
    flat, _, pivoted = curves(results.load(make_results(tmp_path, wide)))
    assert flat.target_size == pivoted.target_size
    assert with_flat_start(pivoted, flat).at.tolist() == [30, 60]
