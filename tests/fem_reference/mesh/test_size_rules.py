"""The growth of the cells is chosen so that the error that all levels share is small beside what was asked for."""

import pytest

from fem_reference.answer.convergence import shared_error
from fem_reference.mesh.size_rules import growth_for, sizing_for


@pytest.mark.parametrize("rtol", [1e-1, 1e-2, 5e-3, 4.9e-3, 1e-3, 2e-4, 1.9e-4, 1e-4])
def test_shared_error_is_well_below_the_accuracy_asked_for(rtol: float) -> None:
    assert shared_error(growth_for(rtol)) <= rtol / 4


def test_cells_grow_no_faster_where_more_accuracy_is_asked_for() -> None:
    growths = [growth_for(rtol) for rtol in (1e-1, 5e-3, 1e-3, 1e-4)]
    assert growths == sorted(growths, reverse=True)
    assert growths[0] > growths[2] > growths[-1]


def test_what_is_asked_coarsely_is_meshed_coarsely() -> None:
    coarse, fine = sizing_for(2e-2, 1.0), sizing_for(1e-2, 1.0)
    assert coarse.curvature > fine.curvature and coarse.far > fine.far
    assert coarse.edge == fine.edge and coarse.edge_in_gap == fine.edge_in_gap
