"""The value between both bounds of one mesh, and the kinds of cells that decide where it lies."""

from __future__ import annotations

import numpy as np

from fem_reference.bodies.conductors import normalised
from fem_reference.bodies.shapes import Body, Cuboid, Rectangle
from fem_reference.mesh.quarter_points import is_pulled
from fem_reference.mesh.size_rules import Sizing
from fem_reference.mesh.tagged_mesh import tagged_mesh
from fem_reference.solve.cell_gaps import BoundedMatrix
from fem_reference.solve.shares import (
    ELSEWHERE,
    ERROR,
    OF_UPPER,
    SHEET_EDGES,
    SOLID_EDGES,
    Shares,
    estimated,
    shares_by_kind,
)


def test_the_value_lies_by_the_shares_in_the_gaps_and_the_errors_add_up() -> None:
    truth = np.array([[2.0, -1.0], [-1.0, 3.0]])
    gaps = np.array([[[0.2, -0.1], [-0.1, 0.3]], [[0.1, 0.05], [0.05, 0.2]]])
    outside = np.diag([0.01, 0.02])
    of_upper, error = np.array([0.2, 0.5, 0.1]), np.array([0.1, 0.2, 0.3])
    upper = truth + 0.2 * gaps[0] + 0.5 * gaps[1] + 0.1 * outside
    lower, shift = upper - gaps.sum(axis=0) - outside, 0.03 * gaps
    found = estimated(BoundedMatrix(lower, upper, gaps, shift), Shares(of_upper, error))
    np.testing.assert_allclose(found.value, truth, rtol=1e-12)
    # What curved surfaces change is no part of the gap, and counts as a whole.
    of_gaps = 0.1 * np.abs(gaps[0]) + 0.2 * np.abs(gaps[1]) + 0.3 * outside
    np.testing.assert_allclose(found.error, of_gaps + np.abs(shift).sum(axis=0))


def test_cells_are_told_apart_by_the_edges_that_they_touch() -> None:
    bodies: list[Body] = [
        Rectangle("plate", np.zeros(3), np.eye(3), (0.5, 0.4)),
        Cuboid("box", np.array([0.1, 0.0, 1.0]), np.eye(3), (0.3, 0.4, 0.2)),
    ]
    problem = normalised(["plate", "box"], 1, bodies, range(2))
    mesh = tagged_mesh(problem.bodies, problem.owner, Sizing(growth=0.6))
    found = shares_by_kind(mesh, problem.bodies)
    assert found.of_upper[-1] == OF_UPPER[ELSEWHERE] and found.error[-1] == ERROR[ELSEWHERE]
    own = found.of_upper[:-1]
    np.testing.assert_array_equal(own == OF_UPPER[SHEET_EDGES], is_pulled(mesh.on_edge))
    corners = mesh.mesh.geometry.x[mesh.mesh.geometry.dofmap.array.reshape(mesh.local_cells, -1)[:, :4]]
    box = problem.bodies[1]
    assert isinstance(box, Cuboid)
    beyond = np.abs(np.abs(corners - box.centre) - np.array(box.half_widths))
    inside = np.all(np.abs(corners - box.centre) <= np.array(box.half_widths) + 1e-7, axis=2)
    touches = (((beyond < 1e-7).sum(axis=2) >= 2) & inside).any(axis=1)
    np.testing.assert_array_equal(own == OF_UPPER[SOLID_EDGES], touches & ~is_pulled(mesh.on_edge))
