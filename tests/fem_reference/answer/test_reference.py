"""When an answer counts as reached, and when no finer mesh is solved: what wraps cost is more than was asked for."""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import Any, cast

import numpy as np
import pytest

from fem_reference.answer import reference
from fem_reference.answer.convergence import Estimate
from fem_reference.answer.reference import ErrorKind, Reference, first_refinement
from fem_reference.answer.shared_errors import GeometryError
from fem_reference.bodies.conductors import Measured
from fem_reference.mesh.marks import Marks
from fem_reference.mesh.sizing import Sizing
from fem_reference.output.documents import table
from fem_reference.solve.enclosure import Enclosure
from fem_reference.solve.level import Level, LevelBounds, solve_level
from tests.fem_reference.problems import PLATE, conductors_of, plate

ONE_PLATE = conductors_of([PLATE])


@cache
def coarse(error: ErrorKind) -> Level:
    """Its solution on a coarse mesh."""
    return solve_level(ONE_PLATE, 1.0, Sizing(growth=0.6), error, ONE_PLATE.mirror_planes)


def answer(levels: int, error: float) -> Reference:
    """The answer for a single sensor, M = 1 F ± `error`, from this number of levels."""
    one = np.ones((1, 1))
    level = Level(1e-3, 1000, 100, one, one, np.zeros(1))
    matrix = Estimate(one, error * one, np.zeros((1, 1), dtype=bool))
    change = Estimate(np.zeros(1), np.zeros(1), np.zeros(1, dtype=bool))
    return Reference(ONE_PLATE, matrix, change, (level,) * levels, rtol=1e-3, seconds=1.0)


@pytest.mark.parametrize(
    "levels, error, reached", [(3, 9e-4, True), (3, 1.1e-3, False), (2, 9e-4, False), (1, 0.0, False)]
)
def test_reached_takes_a_small_error_and_three_levels(levels: int, error: float, reached: bool) -> None:
    assert answer(levels, error).reached is reached


def test_an_estimate_between_both_bounds_takes_one_level() -> None:
    found = answer(1, 9e-4)
    likely = found.maxwell.value, found.maxwell.error
    wide = Enclosure(found.lower - 1, found.upper + 1)
    between = replace(found.levels[0], bounds=LevelBounds(wide, likely, None, cast(Marks, None)))
    assert not found.reached and replace(found, levels=(between,)).reached


def test_the_interval_is_the_value_and_its_error() -> None:
    found = answer(3, 0.25)
    assert (found.lower[0, 0], found.upper[0, 0], found.worst) == (0.75, 1.25, 0.25)


@pytest.mark.parametrize("gap, refinement", [(0.04, 0.5), (0.1, 1.0)])
def test_scenes_with_narrow_gaps_start_coarser(gap: float, refinement: float) -> None:
    assert first_refinement(conductors_of([PLATE, plate("above", (0.5, 0.5), 0, 0, gap)])) == refinement


@pytest.mark.parametrize(
    "failure", [MemoryError(), RuntimeError("solving the equations failed: error code 55")]
)
def test_what_does_not_fit_in_memory_ends_with_the_answer_so_far(
    monkeypatch: pytest.MonkeyPatch, failure: Exception
) -> None:
    levels: Iterator[Level] = iter([coarse("enclosure")])

    def limited(*_: Any) -> Level:
        for level in levels:
            return level
        raise failure

    monkeypatch.setattr(reference, "solve_level", limited)
    found = reference.solve_conductors(ONE_PLATE, rtol=1e-5)
    assert not found.reached and len(found.levels) == 1 and found.enclosure is not None
    assert found.stopped_by == "the next level took more memory than there is"


@pytest.mark.parametrize("error", ["enclosure", "estimate"])
def test_bounds_of_meshes_that_exclude_each_other_never_pass_silently(
    monkeypatch: pytest.MonkeyPatch, error: ErrorKind
) -> None:
    """The second mesh has other bounds than the first, as a mistake of a mesh or of the solver would have; only the sizes are the solver's."""
    known = coarse(error).bounds
    assert known is not None
    interval = Enclosure(1.1 * known.interval.lower, 1.1 * known.interval.upper)
    likely = None if known.likely is None else (1.1 * known.likely[0], 1.1 * known.likely[1])
    bounds = replace(known, interval=interval, likely=likely)
    levels = iter([coarse(error), replace(coarse(error), maxwell=1.1 * coarse(error).maxwell, bounds=bounds)])
    monkeypatch.setattr(reference, "solve_level", lambda *_: next(levels))
    monkeypatch.setattr(reference, "MOST_LEVELS", 2)
    found = reference.solve_conductors(ONE_PLATE, rtol=1e-5, error=error)
    assert found.contradicted is not None and "bounds of two meshes exclude each other" in found.contradicted
    assert not found.reached and not replace(found, rtol=1.0).reached
    first, second = (factor * coarse(error).maxwell[0, 0] for factor in (1, 1.1))
    assert found.lower[0, 0] < first < found.upper[0, 0] and found.lower[0, 0] < second < found.upper[0, 0]
    assert found.maxwell.error[0, 0] > 0.04 * first and "proven to lie" not in table(found)


GROWTH = np.array([[0.02, -0.01], [-0.01, 0.04]])
MAXWELL = np.array([[2.0, -0.1], [-0.1, 8.0]])
COST = GeometryError(
    GROWTH, np.array([0.01]), np.ones((2, 2), bool), np.ones((2, 2), bool), np.array([0.003])
)


@pytest.mark.parametrize(
    "only_readings, delta_self, change, least",
    [(False, 1.0, 1.0, 0.1), (False, 0.05, 1.0, 0.2), (True, 0.05, 1.0, 0.01), (True, 0.05, 0.1, 0.03)],
)
def test_the_least_error_is_that_of_what_was_asked_for(
    only_readings: bool, delta_self: float, change: float, least: float
) -> None:
    reading = Measured("front", 0, (0,))
    found = COST.least_error(MAXWELL, np.array([delta_self]), [reading], np.array([change]), only_readings)
    assert found == pytest.approx(least)
