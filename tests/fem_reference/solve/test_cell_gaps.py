"""The gaps of the cells add up to the gap between the bounds of the energies, for every kind of cell; the value between both bounds of
one mesh, and the kinds of cells that decide where it lies. Repeated solution of one level in one process: its memory is freed."""

from pathlib import Path
from resource import getpagesize

import numpy as np
import pytest

from fem_reference.bodies.round_bodies import Sphere
from fem_reference.bodies.shapes import Body, Cuboid, Disc
from fem_reference.mesh.marks import marks
from fem_reference.mesh.quarter_points import is_pulled
from fem_reference.mesh.sizing import Sizing
from fem_reference.mesh.tagged_mesh import tagged_mesh
from fem_reference.solve.cell_gaps import BoundedMatrix, bounded_matrix
from fem_reference.solve.field_problem import FieldProblem
from fem_reference.solve.flux import CondensedCells
from fem_reference.solve.level import Bounds, solve_level
from fem_reference.solve.two_sided import (
    ELSEWHERE,
    ERROR,
    OF_UPPER,
    Quantities,
    SHEET_EDGES,
    SOLID_EDGES,
    Shares,
    entries,
    estimated,
    parts_of_errors,
    shares_by_kind,
)
from tests.by_night import all_but
from tests.fem_reference.problems import conductors_of, plate

COARSE = Sizing(edge=0.4, edge_in_gap=1.0, growth=0.6, curvature=0.6)


def test_gaps_of_cells_are_positive_and_add_up_to_the_gap_of_the_energies() -> None:
    """Plates with quarter-point cells, a cuboid, a floating ball with curved cells, and a disc that is only grounded."""
    bodies: list[Body] = [
        plate("plate", (0.5, 0.4)),
        Cuboid("box", np.array([0.1, 0, 0.7]), np.eye(3), (0.3, 0.2, 0.2)),
        Sphere("ball", np.array([1.2, 0, 0.4]), 0.3),
        Disc("disc", np.array([0, 0, -0.6]), np.eye(3), 0.5),
    ]
    problem = conductors_of(bodies, floating=("ball",), grounded=("disc",))
    mesh = tagged_mesh(problem, COARSE)
    system = FieldProblem(mesh, problem)
    potentials = system.potentials(range(4), 3)
    found = bounded_matrix(system, CondensedCells(mesh, 3), potentials, problem.parts, {}, 1)
    gap = found.upper - found.lower
    outside = gap - found.gaps.sum(axis=0)
    assert found.gaps.shape == (mesh.local_cells, 2, 2)
    assert np.linalg.eigvalsh(found.gaps).min() > -1e-9 * np.trace(gap)
    # What is left is the gap outside of the mesh, and the quadrature in curved cells.
    assert np.abs(outside).max() < 1e-3 * np.trace(gap)
    parts = parts_of_errors(found, entries(2), mesh.rim_error, [])
    collected = marks(problem, *mesh.corners(), parts.of_cells, parts.whole)
    total = collected.at_edges.sum(axis=0) + collected.away.sum(axis=0) + collected.rest
    np.testing.assert_allclose(total, parts.whole, rtol=1e-9)
    half_width = np.sqrt(np.outer(np.diag(gap), np.diag(gap))) / 2
    middle = np.abs(found.lower + found.upper) / 2
    assert np.all(parts.whole >= (half_width / middle)[np.triu_indices(2)])
    # A reading of both conductors' charge has the parts of the sum of their voltages.
    both = Quantities(np.array([[1.0, 0.0]]), np.array([[1.0, 1.0]]))
    reading = parts_of_errors(found, both, 0.0, [])
    gaps = np.array([[gap[0, 0], gap.sum()]])
    expected = np.sqrt(gaps.prod()) / 2 / np.abs((found.lower + found.upper)[0].sum() / 2)
    np.testing.assert_allclose(reading.whole, expected, rtol=1e-9)
    # The sides along edges make up the edges: four of the plate, twelve of the box, and the chords of the disc's circle.
    lengths = np.linalg.norm(collected.sides[:, 1] - collected.sides[:, 0], axis=1).sum() * problem.unit
    edges = 4 * (0.5 + 0.4) + 8 * (0.3 + 0.2 + 0.2)
    assert edges + 0.9 * np.pi < lengths < edges + np.pi


def test_the_value_lies_by_the_shares_in_the_gaps_and_the_errors_add_up() -> None:
    truth = np.array([[2.0, -1.0], [-1.0, 3.0]])
    gaps = np.array([[[0.2, -0.1], [-0.1, 0.3]], [[0.1, 0.05], [0.05, 0.2]]])
    outside = np.diag([0.01, 0.02])
    of_upper, error = np.array([0.2, 0.5, 0.1]), np.array([0.1, 0.2, 0.3])
    upper = truth + 0.2 * gaps[0] + 0.5 * gaps[1] + 0.1 * outside
    lower, shift = upper - gaps.sum(axis=0) - outside, 0.03 * gaps
    found = estimated(BoundedMatrix(lower, upper, gaps, shift), Shares(of_upper, error))
    np.testing.assert_allclose(found.value, truth, rtol=1e-12)
    # The shift by curved surfaces counts as a whole: the gap does not contain it.
    of_gaps = 0.1 * np.abs(gaps[0]) + 0.2 * np.abs(gaps[1]) + 0.3 * outside
    np.testing.assert_allclose(found.error, of_gaps + np.abs(shift).sum(axis=0))


def test_cells_are_told_apart_by_the_edges_that_they_touch() -> None:
    cuboid = Cuboid("box", np.array([0.1, 0.0, 1.0]), np.eye(3), (0.3, 0.4, 0.2))
    problem = conductors_of([plate("plate", (0.5, 0.4)), cuboid])
    mesh = tagged_mesh(problem, Sizing(growth=0.6))
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


def memory_in_use() -> int:
    """The memory (bytes) that the process holds now."""
    return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * getpagesize()


@pytest.mark.parametrize("bounds", all_but(["enclosure"], ["none", "estimate", "enclosure"]))
def test_a_level_leaves_no_memory_behind(bounds: Bounds) -> None:
    """The matrices of the level take some 10 MB, its bounds three times as much."""
    problem = conductors_of([plate("a"), plate("b", (0.5, 0.5), 0, 0, 0.4)])
    used = []
    for _ in range(4):
        solve_level(problem, 1.0, Sizing(), bounds, problem.mirror_planes)
        used.append(memory_in_use())
    assert used[3] - used[1] < 5 * 2**20
