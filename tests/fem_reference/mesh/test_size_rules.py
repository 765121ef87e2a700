"""The sizes of the cells follow the accuracy that was asked for."""

from fem_reference.mesh.size_rules import sizing_for


def test_cells_grow_no_faster_where_more_accuracy_is_asked_for() -> None:
    growths = [sizing_for(rtol, 1.0).growth for rtol in (1e-1, 1e-3, 9e-4, 1e-4)]
    assert growths == sorted(growths, reverse=True)
    assert growths[0] == growths[1] > growths[2] > growths[3]


def test_what_is_asked_coarsely_is_meshed_coarsely() -> None:
    coarse, fine = sizing_for(2e-2, 1.0), sizing_for(1e-2, 1.0)
    assert coarse.curvature > fine.curvature and coarse.far > fine.far
    assert coarse.edge == fine.edge and coarse.edge_in_gap == fine.edge_in_gap
