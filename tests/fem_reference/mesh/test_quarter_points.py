"""Quarter-point elements: the formula of their map, and the exactness of their integrals."""

import math
from itertools import combinations

import numpy as np
import pytest

from fem_reference.mesh import quarter_points
from fem_reference.mesh.quarter_points import (
    aligned_rule,
    is_pulled,
    jacobian,
    patterns,
    pull,
    second_order,
    straighten,
)
from fem_reference.solve.reference_flux import flux_space
from geometries.common.arrays import Array

KINDS = [frozenset(chosen) for count in (1, 2, 3) for chosen in combinations(range(4), count)]


def barycentric(points: Array) -> Array:
    return np.column_stack([1 - points.sum(axis=1), points])


def some_points() -> Array:
    spread = np.random.default_rng(1).dirichlet(np.ones(4), 50)
    return np.asarray(spread[:, 1:])


@pytest.mark.parametrize("collapsed", KINDS)
def test_the_element_is_the_straight_one_with_the_distance_squared(collapsed: frozenset[int]) -> None:
    """The map takes (1 − s)·P + s·Q to (1 − s²)·P' + s²·Q' in any tetrahedron."""
    corners = np.random.default_rng(2).normal(size=(4, 3))
    nodes = np.vstack([corners, np.zeros((6, 3))])
    cell = np.arange(10, dtype=np.int32)[None]
    straighten(nodes, cell)
    pull(nodes, cell, np.array([[k in collapsed for k in range(4)]]))
    points = some_points()
    mapped = second_order().tabulate(0, points)[0][:, :, 0] @ nodes
    weights = barycentric(points)
    near = [k in collapsed for k in range(4)]
    s = 1 - weights[:, near].sum(axis=1, keepdims=True)
    expected = (1 + s) * (weights[:, near] @ corners[near]) + s * (
        weights[:, np.logical_not(near)] @ corners[np.logical_not(near)]
    )
    np.testing.assert_allclose(mapped, expected, atol=1e-14)


@pytest.mark.parametrize("collapsed", KINDS)
def test_the_determinant_vanishes_on_the_edge_as_the_notes_say(collapsed: frozenset[int]) -> None:
    points = some_points()
    s = 1 - barycentric(points)[:, sorted(collapsed)].sum(axis=1)
    count = len(collapsed)
    expected = 2 * s ** (4 - count) * (1 + s) ** (count - 1)
    np.testing.assert_allclose(np.linalg.det(jacobian(collapsed, points)), expected, rtol=1e-12)


@pytest.mark.parametrize("collapsed", KINDS)
def test_the_rule_integrates_polynomials(collapsed: frozenset[int]) -> None:
    """∫ Π λ_k^(n_k) over the reference tetrahedron is Π n_k! / (3 + Σ n_k)!."""
    points, weights = aligned_rule(collapsed, 8)
    for powers in ((0, 0, 0, 0), (3, 1, 2, 2), (8, 0, 0, 0), (0, 2, 0, 5)):
        value = weights @ np.prod(barycentric(points) ** powers, axis=1)
        exact = math.prod(map(math.factorial, powers)) / math.factorial(3 + sum(powers))
        assert value == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("collapsed", KINDS)
def test_energies_of_fluxes_do_not_depend_on_the_rule(
    collapsed: frozenset[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The energies are finite and integrated to rounding error: a rule with one and a half times the points gives the same."""
    found = flux_space(3, collapsed).products
    with monkeypatch.context() as patch:
        patch.setattr(quarter_points, "RADIAL_DEGREE", 35)
        caches = aligned_rule, flux_space
        for cache in caches:
            cache.cache_clear()
        finer = flux_space(3, collapsed).products
        for cache in caches:
            cache.cache_clear()
    traces = [np.einsum("ddnn->", products) for products in (found, finer)]
    assert traces[0] == pytest.approx(traces[1], rel=1e-11)
    np.testing.assert_allclose(found, finer, atol=1e-10 * np.abs(found).max())


def test_a_cell_with_all_vertices_on_edges_is_straight() -> None:
    on_edge = np.array([[False] * 4, [True, False, True, False], [True] * 4])
    assert is_pulled(on_edge).tolist() == [False, True, False]
    assert {kind: cells.tolist() for kind, cells in patterns(on_edge)} == {
        frozenset(): [0, 2],
        frozenset({0, 2}): [1],
    }
