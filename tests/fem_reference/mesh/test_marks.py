"""The sizes that errors ask for: the fewest cells for a given error, and no more error than asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fem_reference.mesh.marks import ORDER_ACROSS_GAPS, Marks, adapted_sizes


def chain(errors: list[float], away: list[float] | None = None) -> Marks:
    """Marks of an edge of sides of length 0.1 between vertices with these errors, and of cells of size 0.2 away from it."""
    count, others = len(errors), np.array(away or [])
    vertices = np.stack([0.1 * np.arange(count), np.zeros(count), np.zeros(count)], axis=1)
    ends = np.stack([np.arange(count - 1), np.arange(1, count)], axis=1)
    full = np.full(count, 0.1)
    places = np.tile([0.0, 5.0, 0.0], (len(others), 1))
    return Marks(
        vertices[ends],
        ends,
        full,
        np.full(count, np.inf),
        full,
        np.array(errors)[:, None],
        np.full(count, 30),
        30 * count + len(others),
        places,
        np.full(len(others), 0.2),
        others[:, None],
        np.zeros(1),
    )


def test_equal_errors_are_reduced_by_equal_sizes() -> None:
    found = adapted_sizes(chain([1.0] * 50), 25.0, 1.0)
    np.testing.assert_allclose(found.sizes, 0.05, rtol=1e-6)
    assert found.growth_of_cells == pytest.approx(2, rel=1e-6)


@pytest.mark.parametrize("order", [1.0, 1.4])
def test_the_error_is_that_asked_for_with_fewer_cells_than_equal_sizes_take(order: float) -> None:
    errors = np.repeat([4.0, 1.0, 0.25, 1.0], 50)
    goal = 0.3 * errors.sum()
    found = adapted_sizes(chain(errors.tolist()), goal, order)
    at_sides = errors[:-1]
    inside = np.diff(errors) == 0
    sizes = found.sizes[inside] / 0.1
    # Errors that are 4 times as large ask for sizes that are smaller by the power 1/(order + 1) of it.
    powers = sizes ** (order + 1) * at_sides[inside]
    np.testing.assert_allclose(powers, powers[0], rtol=1e-6)
    assert (sizes**order * at_sides[inside]).sum() == pytest.approx(goal, rel=0.05)
    assert found.growth_of_cells < 0.3 ** (-1 / order)


def test_every_quantity_reaches_the_goal() -> None:
    one = chain([1.0] * 40 + [1e-9] * 40)
    other = chain([1e-9] * 40 + [2.0] * 40)
    both = replace(one, at_edges=np.concatenate([one.at_edges, other.at_edges], axis=1), rest=np.zeros(2))
    found = adapted_sizes(both, 20.0, 1.0)
    assert found.sizes[10] <= 0.0501 and found.sizes[-10] <= 0.0251


def test_cells_away_from_edges_are_divided_only_where_they_matter() -> None:
    found = adapted_sizes(chain([1.0] * 20, [1e-12] * 5 + [3.0]), 10.0, 1.0)
    assert len(found.sizes) == 19 + 1 and found.sizes[-1] < 0.2 / 1.15
    np.testing.assert_allclose(found.triangles[-1], np.tile([0.0, 5.0, 0.0], (3, 1)))


def test_a_mesh_that_is_too_fine_becomes_coarser_within_limits() -> None:
    found = adapted_sizes(chain([1e-6] * 20), 10.0, 1.0)
    np.testing.assert_allclose(found.sizes, 0.3)


def test_cells_that_reach_across_a_gap_have_a_higher_order_and_stay_larger() -> None:
    near = np.repeat([0.2, 1.0], 40)
    found = replace(chain([1.0] * 80), gaps=near)
    orders = found.orders(1.2)
    np.testing.assert_array_equal(orders, np.repeat([ORDER_ACROSS_GAPS, 1.2], 40))
    sizes = adapted_sizes(found, 20.0, orders).sizes / 0.1
    assert sizes[10] > 1.2 * sizes[-10]
    left = 40 * (sizes[10] ** ORDER_ACROSS_GAPS + sizes[-10] ** 1.2)
    assert left == pytest.approx(20, rel=0.01)
