"""The option --columns: the result is the submatrix of the whole matrix, with its bounds."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from fem_reference import maxwell
from fem_reference.output.documents import table
from fem_reference.answer.reference import Reference
from geometries.scene.reader import loads
from tests import scenes

SCENE = (
    scenes.sensor("left", [[-0.11, -0.05, 0], [0.1, 0, 0], [0, 0.1, 0]])
    + scenes.sensor("right", [[0.01, -0.05, 0], [0.1, 0, 0], [0, 0.1, 0]])
    + scenes.body("grounded", "plate", size=[0.08, 0.08], translation=[0.02, 0, 0.05])
    + scenes.body("floating", "plate", size=[0.05, 0.1], translation=[-0.06, 0, 0.06], potential="floating")
)


@cache
def solved(*columns: str) -> Reference:
    return maxwell(loads(SCENE), max_seconds=1e-3, columns=columns)


@pytest.mark.night
def test_what_was_asked_for_is_a_part_of_the_whole() -> None:
    """The mesh is coarser around what was not asked for; the intervals of both meshes hold the truth."""
    whole, part = solved(), solved("grounded", "right")
    assert (
        part.names == ("right", "grounded")
        and part.problem.grounded == ("left",)
        and whole.problem.grounded == ()
    )
    kept = np.ix_(*[[whole.names.index(name) for name in part.names]] * 2)
    assert np.all(part.lower <= whole.upper[kept]) and np.all(whole.lower[kept] <= part.upper)


def test_a_sensor_nobody_asked_for_takes_fewer_cells() -> None:
    whole, part = solved(), solved("right")
    assert part.levels[0].unknowns < whole.levels[0].unknowns
    assert part.maxwell.error[0, 0] < 1.2 * whole.maxwell.error[1, 1]


def test_the_change_of_a_sensor_is_the_same_beside_a_sensor_nobody_asked_for() -> None:
    whole, part = solved(), solved("grounded", "right")
    assert part.delta_self.value.shape == (1,)
    allowed = part.delta_self.error[0] + whole.delta_self.error[1]
    assert abs(part.delta_self.value[0] - whole.delta_self.value[1]) <= allowed
    assert allowed < 0.1 * whole.delta_self.value[1]


def test_the_table_names_what_has_no_row_and_why() -> None:
    lines = table(solved("grounded", "right")).splitlines()
    assert "grounded, their columns not asked for: left" in lines
    assert "floating, without charge and so without a row: floating" in lines


def test_an_object_alone_has_no_change_of_a_sensor() -> None:
    found = maxwell(loads(SCENE), max_seconds=1e-3, columns=["grounded"], error="estimate")
    assert found.names == ("grounded",) and found.delta_self.value.shape == (0,) and 0 < found.worst < 0.1
