"""The regions around a sensor, and the error of splitting in each."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis.results import study_results as results
from analysis.results.set_up import rectangles
from analysis.topics.experiments.splitting import (
    AT_CORNER,
    BESIDE_EDGE,
    IN_FRONT,
    SEVERAL,
    accuracies,
    region,
)
from analysis.topics.experiments.splitting import finding
from geometries.scene.scene import Scene
from geometries.studies import families
from tests.analysis.synthetic import EDGE, PARALLEL, make_results, model_document

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
    text = finding(accuracies(results.load(make_results(tmp_path, PARALLEL + EDGE, answers))))
    assert (
        text.startswith("After 4 splits")
        and "region I 0.001 % (0.001 %), region II 0.001 % (0.001 %)" in text
    )
    assert "below the exact integral in 50 % of all" in text
