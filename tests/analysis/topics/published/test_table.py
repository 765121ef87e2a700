"""The published table: what it promises of every row, and rows solved anew."""

import random
from collections import Counter
from pathlib import Path

import pytest

from analysis.pipeline.model_stage import model_module
from analysis.results.set_up import rectangles
from analysis.topics.published import topic
from analysis.topics.published.topic import QUANTITIES, Row
from geometries.common.measured import PICOFARAD
from geometries.studies.study import Case

MOST_ERROR = 5e-5
"""The largest stated error of a value, relative to it."""


@pytest.fixture(scope="module")
def published() -> list[Row]:
    return topic.load()[0]


@pytest.fixture(scope="module")
def cases() -> dict[str, Case]:
    return {case.id: case for case in topic.cases()}


def test_every_set_up_of_the_study_has_a_row_with_its_geometry(
    published: list[Row], cases: dict[str, Case]
) -> None:
    assert [row.case for row in published] == list(cases)
    assert len(published) >= 500
    assert set(Counter(row.family for row in published)) == {"inclined", "edge", "corner"}
    for row in published:
        plates = rectangles(cases[row.case].scene)
        assert plates is not None
        for vector in ("corner", "edge_u", "edge_v"):
            assert getattr(row.target, vector) == pytest.approx(getattr(plates[1], vector), abs=1e-11)


def test_every_value_is_enclosed_and_good_to_four_digits(published: list[Row]) -> None:
    for row in published:
        for quantity in QUANTITIES:
            value = row.values[quantity]
            assert 0 < value.low <= value.best <= value.high, (row.case, quantity)
            # To the rounding of what is written down.
            assert value.error <= MOST_ERROR * value.best + 2e-6, (row.case, quantity)


def test_the_page_tells_what_is_in_the_files() -> None:
    found, checks = topic.load()
    text = (topic.PLACE / topic.PAGE).read_text(encoding="utf-8")
    assert topic.headline(found) in text and topic.check_finding(checks) in text


def test_the_field_solvers_own_best_values_agree() -> None:
    checks = topic.load()[1]
    assert {check.quantity for check in checks} == set(QUANTITIES)
    assert all(check.value.agrees_with(check.best) for check in checks)


def test_rows_drawn_by_chance_are_found_again(
    published: list[Row], cases: dict[str, Case], tmp_path: Path
) -> None:
    """By boundary elements anew, within the errors of both."""
    for row in random.SystemRandom().sample(published, 2):
        scene = tmp_path / "scene.toml"
        scene.write_text(cases[row.case].text)
        solved = model_module().Scene.load(scene).maxwell(rtol=MOST_ERROR)
        matrix, error, change = solved["maxwell"], solved["error"], solved["delta_self"]["sensor"]
        found = {
            topic.MUTUAL: (-matrix[0][1], error[0][1]),
            topic.SENSOR: (matrix[0][0], error[0][0]),
            topic.TARGET: (matrix[1][1], error[1][1]),
            topic.DELTA_SELF: (change["value"], change["error"]),
        }
        for quantity, (value, uncertain) in found.items():
            told = row.values[quantity]
            assert abs(value / PICOFARAD - told.best) <= told.error + uncertain / PICOFARAD, row.case
