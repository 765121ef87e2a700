"""The published table: what it promises of every row, rows solved anew, and how bounds become intervals."""

from __future__ import annotations

import random
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from analysis import __main__ as command_line
from analysis.pipeline.model_stage import model_module
from analysis.results import store
from analysis.results.set_up import rectangles
from analysis.results.study_results import SCENE, Failure
from analysis.topics.published import files, page, rows, stage, table, upper_bound
from analysis.topics.published.rows import DELTA_SELF, MUTUAL, QUANTITIES, Row
from geometries.studies import study
from geometries.studies.study import EMPTY, Case

PICO = 1e-12


@pytest.fixture(scope="module")
def published() -> list[Row]:
    return files.load(table.PLACE)[0]


@pytest.fixture(scope="module")
def cases() -> dict[str, Case]:
    return {case.id: case for case in stage.cases()}


def test_every_set_up_of_the_study_has_a_row_with_its_geometry(
    published: list[Row], cases: dict[str, Case]
) -> None:
    assert [row.case for row in published] == [case.id for case in cases.values() if case.family != EMPTY]
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
            assert value.error <= stage.FOUR_DIGITS * value.best + 2e-6, (row.case, quantity)


def test_the_page_tells_what_is_in_the_files() -> None:
    assert (table.PLACE / files.PAGE).read_text(encoding="utf-8") == page.text(*files.load(table.PLACE))


def test_the_field_solvers_own_best_values_agree() -> None:
    checks = files.load(table.PLACE)[1]
    assert {check.quantity for check in checks} == set(QUANTITIES)
    assert all(check.agrees for check in checks)


def test_rows_drawn_by_chance_are_found_again(
    published: list[Row], cases: dict[str, Case], tmp_path: Path
) -> None:
    """Both methods anew: the best values within the stated errors, each method's bound on its side of the other's best value."""
    for row in random.SystemRandom().sample(published, 2):
        scene = tmp_path / row.case / SCENE
        store.write_text(scene, cases[row.case].text)
        solved = stage.boundary(model_module(), scene)
        matrix, error, change = (
            np.array(solved["maxwell"]),
            np.array(solved["error"]),
            solved["delta_self"]["sensor"],
        )
        found = {
            MUTUAL: (-matrix[0, 1], error[0, 1]),
            rows.SENSOR: (matrix[0, 0], error[0, 0]),
            rows.TARGET: (matrix[1, 1], error[1, 1]),
            DELTA_SELF: (change["value"], change["error"]),
        }
        for quantity, (value, uncertain) in found.items():
            told = row.values[quantity]
            assert abs(value / PICO - told.best) <= told.error + uncertain / PICO, (row.case, quantity)
        upper = upper_bound.bound(scene, refinement=1.0).upper / PICO
        for place, quantity in enumerate((rows.SENSOR, rows.TARGET)):
            assert upper[place, place] > row.values[quantity].best, (row.case, quantity)


def test_errors_are_taken_off_the_lower_bound_as_row_sums() -> None:
    boundary = {
        "maxwell": [[4.0, -1.0], [-1.0, 3.0]],
        "error": [[0.1, 0.02], [0.02, 0.2]],
        "lower_bounds": [True, True],
    }
    assert rows.lower_matrix(boundary) == pytest.approx(np.array([[3.88, -1.0], [-1.0, 2.78]]))
    with pytest.raises(ValueError, match="not accurate enough for a lower bound"):
        rows.lower_matrix(boundary | {"lower_bounds": [True, False]})


@pytest.mark.parametrize(
    ("alone", "expected"),
    [
        # From the energies: [4.0, 4.1] less [3.2, 3.3].
        ((3.2, 3.3), (0.7, 0.9)),
        # 1² / 2.1, where the energies say no more than 0.4.
        ((3.2, 3.6), (1 / 2.1, 0.9)),
        # mutual, where the energies say no less than 1.6.
        ((2.5, 3.3), (0.7, 1.2)),
    ],
)
def test_delta_self_is_bounded_by_energies_and_by_what_targets_do(
    alone: tuple[float, float], expected: tuple[float, float]
) -> None:
    low, high = np.array([[4.0, -1.2], [-1.2, 2.0]]), np.array([[4.1, -1.0], [-1.0, 2.1]])
    assert rows.delta_self_bounds(low, high, rows.Alone(*alone)) == pytest.approx(expected)


def made_up(case: Case) -> Row:
    """Galerkin 4, −1 and 2 pF with errors of 1e-5 pF, energies 1 % above."""
    boundary = {
        "maxwell": [[4 * PICO, -PICO], [-PICO, 2 * PICO]],
        "error": [[1e-5 * PICO] * 2] * 2,
        "lower_bounds": [True, True],
        "delta_self": {"sensor": {"value": 0.6 * PICO, "error": 1e-5 * PICO}},
    }
    upper = {"upper": [[4.04 * PICO, -1.01 * PICO], [-1.01 * PICO, 2.02 * PICO]]}
    return rows.row(case, boundary, upper, rows.Alone(3.39 * PICO, 3.41 * PICO))


def test_bounds_are_rounded_outwards_and_come_back_from_the_file(cases: dict[str, Case]) -> None:
    case = next(iter(cases.values()))
    row = made_up(case)
    assert row.values[rows.SENSOR].low == pytest.approx(4 - 2e-5) and row.values[rows.SENSOR].high == 4.04
    # ±½√(0.04·0.02) about −1.005, all but the errors.
    half = np.sqrt(0.04002 * 0.02002) / 2
    assert row.values[MUTUAL].low <= 1.005 - half < row.values[MUTUAL].low + 1e-6
    assert row.values[MUTUAL].high - 1e-6 < 1.005 + half <= row.values[MUTUAL].high
    (back,) = files.from_csv(files.to_csv([row]))
    assert (back.case, back.family, back.parameters) == (row.case, row.family, row.parameters)
    assert back.values == row.values


def test_a_best_value_outside_its_bounds_is_refused(cases: dict[str, Case]) -> None:
    case = next(iter(cases.values()))
    outside = {
        "maxwell": [[4 * PICO, -PICO], [-PICO, 2 * PICO]],
        "error": [[0.0] * 2] * 2,
        "lower_bounds": [True, True],
        "delta_self": {"sensor": {"value": 0.9 * PICO, "error": 1e-5 * PICO}},
    }
    upper = {"upper": [[4.04 * PICO, -1.01 * PICO], [-1.01 * PICO, 2.02 * PICO]]}
    with pytest.raises(ValueError, match="delta_self .* is outside"):
        rows.row(case, outside, upper, rows.Alone(3.39 * PICO, 3.41 * PICO))


def test_the_options_of_the_command_reach_what_they_are_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked: list[object] = []

    def make(*arguments: object) -> table.Made:
        asked.extend(arguments)
        return table.Made([], "530 set-ups")

    monkeypatch.setattr(table, "make", make)
    answers, output = tmp_path / "answers", tmp_path / "output"
    command = ["table", "--answers", str(answers), "--output", str(output), "--jobs", "3"]
    assert command_line.main(command) == 0
    assert asked == [answers, output, 3]
    assert f"table: {output / files.TABLE}" in capsys.readouterr().out


def test_nothing_is_written_while_a_set_up_has_no_answer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    failure = Failure("0123456789abcdef", "upper bound", "no mesh")
    monkeypatch.setattr(stage, "run", lambda answers, workers: [failure])
    assert table.make(tmp_path, tmp_path / "table").failures == [failure]
    assert not (tmp_path / "table").exists()


def test_the_study_is_of_set_ups_that_have_a_plane_of_symmetry() -> None:
    """As its file says: what halves the field solver's work is there in every one."""
    from fem_reference.bodies.conductors import conductors
    from fem_reference.bodies.symmetry import mirror_planes

    for case in study.load(study.find(stage.STUDY)).cases()[::40]:
        problem = conductors(case.scene)
        assert mirror_planes(problem.bodies, problem.owner), case.parameters
