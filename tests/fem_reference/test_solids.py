"""Meshed solids of every shape: their volumes and sizes are right, and dielectric bodies have their permittivity."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import ufl
from dolfinx import fem

from fem_reference.bodies.conductors import Conductors, Dielectric
from fem_reference.bodies.polyhedron import polyhedron
from fem_reference.bodies.round_bodies import Arc, Cone, Cylinder, Sphere
from fem_reference.bodies.shapes import Body, Cuboid
from fem_reference.mesh.sizing import Sizing
from fem_reference.mesh.tagged_mesh import FIRST_BODY, TaggedMesh, tagged_mesh
from fem_reference.solve.field_problem import Charges, FieldProblem, charges
from geometries.scene import shapes
from tests.fem_reference.problems import CENTRE, ORIGIN, TURNED, conductors_of, plate

CUBE = shapes.Cuboid((1.0, 1.0, 1.0)).triangles() @ TURNED


def solve(problem: Conductors) -> Charges:
    """Solve on the coarsest level, in units of ε times the bodies' unit of length."""
    mesh = tagged_mesh(problem, Sizing())
    found = charges(FieldProblem(mesh, problem), 1, len(problem.floating))
    return replace(
        found, maxwell=problem.unit * found.maxwell, sensors_alone=problem.unit * found.sensors_alone
    )


@pytest.mark.parametrize(
    "body, true, refinement, tolerance",
    [
        (Sphere("sphere", CENTRE, 1.0), 4 / 3 * np.pi, 1, 2e-4),
        (Sphere("sphere, third level", CENTRE, 1.0), 4 / 3 * np.pi, 4, 1e-5),
        (Cylinder("cylinder", CENTRE, TURNED, 1.0, 2.0), 2 * np.pi, 1, 2e-4),
        (Cone("cone", CENTRE, TURNED, 1.0, 2.0), 2 / 3 * np.pi, 1, 2e-4),
        (Arc("arc", CENTRE, TURNED, 1.0, 2.0, 0.8, 1.2), 1.2 * 3 * 0.8, 1, 2e-4),
        (Arc("ring", CENTRE, TURNED, 0.8, 1.2, 0.4, np.pi), np.pi * 0.8 * 0.4, 1, 2e-4),
        (polyhedron("two cubes", np.concatenate([CUBE, CUBE + 3.0])), 2.0, 1, 2e-4),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_a_meshed_solid_has_its_true_volume(
    body: Body, true: float, refinement: float, tolerance: float
) -> None:
    """The error of the second-order cells at the surface falls with the fourth power of their size."""
    problem = conductors_of([body])
    found = volume(tagged_mesh(problem, Sizing(refinement=refinement)), 0) * problem.unit**3
    assert abs(found / true - 1) < tolerance


def volume(mesh: TaggedMesh, body: int) -> float:
    """The volume of the cells in a body."""
    inside = ufl.Measure("dx", domain=mesh.mesh, subdomain_data=mesh.cells)(FIRST_BODY + body)
    return float(fem.assemble_scalar(fem.form(fem.Constant(mesh.mesh, 1.0) * inside)))


def test_of_dielectric_bodies_that_overlap_the_later_one_fills_the_common_space() -> None:
    cubes: list[Body] = [
        Cuboid(name, np.array([x, 0, 0]), np.eye(3), (0.5, 0.5, 0.5)) for name, x in (("a", 0.0), ("b", 0.6))
    ]
    problem = conductors_of(cubes, 0, dielectrics=(Dielectric("a", 2.0, 2.0), Dielectric("b", 5.0, 5.0)))
    mesh = tagged_mesh(problem, Sizing())
    assert np.array([volume(mesh, k) for k in range(2)]) * problem.unit**3 == pytest.approx(
        [0.6, 1.0], rel=1e-9
    )


def slab_between_plates(slab: Cuboid | None, contrast: float) -> Charges:
    plates: list[Body] = [plate("s"), plate("p", (0.5, 0.5), 0, 0, 0.5)]
    if slab is None:
        return solve(conductors_of(plates))
    return solve(conductors_of([*plates, slab], dielectrics=(Dielectric(slab.name, contrast, contrast),)))


@cache
def with_slab(contrast: float) -> Charges:
    """Two plates with a slab that touches both and extends beyond them on one side."""
    slab = Cuboid("slab", np.array([0.1, 0, 0.25]), np.eye(3), (0.6, 0.5, 0.25))
    return slab_between_plates(slab, contrast)


def test_a_dielectric_body_of_the_mediums_permittivity_is_not_there() -> None:
    """Solved on a mesh without the body, the matrix is the same to the mesh error of the coarsest level."""
    bare = slab_between_plates(None, 1.0)
    np.testing.assert_allclose(with_slab(1.0).maxwell, bare.maxwell, rtol=2e-3)
    assert np.array_equal(with_slab(1.0).sensors_alone, with_slab(4.0).sensors_alone)


def test_a_slab_between_plates_raises_their_capacitance_but_not_beyond_its_permittivity() -> None:
    """By Dirichlet's principle the energy grows with the permittivity in any place, and is ε times as large with ε everywhere."""
    medium, slab = with_slab(1.0).maxwell, with_slab(4.0).maxwell
    assert np.linalg.eigvalsh(slab - medium).min() > 0
    assert np.linalg.eigvalsh(4 * medium - slab).min() > 0
    assert -slab[0, 1] > 2 * -medium[0, 1], "most of the flux between the plates is in the slab"


def test_a_cube_given_as_a_mesh_is_the_cube() -> None:
    """Meshes of the same edge size, which differ elsewhere, give the same matrix within a tenth of the error of that size."""
    cuboid = solve(conductors_of([Cuboid("s", ORIGIN, TURNED, (0.5, 0.5, 0.5))]))
    mesh = solve(conductors_of([polyhedron("s", CUBE)]))
    print(f"\ncube as a mesh over cuboid: {mesh.maxwell[0, 0] / cuboid.maxwell[0, 0] - 1:.1e}")
    assert mesh.maxwell[0, 0] == pytest.approx(cuboid.maxwell[0, 0], rel=2e-4)


def test_the_size_in_a_gap_to_a_mesh_is_the_gap() -> None:
    """Measures the edges of the tetrahedra near the point where a corner of a cube is close to a plate."""
    down = polyhedron("cube", CUBE - [0, 0, CUBE[..., 2].min() - 0.1])
    problem = conductors_of([plate("s", (2.0, 2.0)), down])
    tagged = tagged_mesh(problem, Sizing(), straight=True)
    nodes, cells = tagged.mesh.geometry.x, tagged.mesh.geometry.dofmap.array.reshape(-1, 4)
    lowest = down.vertices[down.vertices[:, 2].argmin()]
    under = (np.array([lowest[0], lowest[1], 0.05]) - problem.centre) / problem.unit
    sizes = np.linalg.norm(nodes[cells[:, 1:]] - nodes[cells[:, :1]], axis=2).max(axis=1)
    near = np.linalg.norm(nodes[cells].mean(axis=1) - under, axis=1) < 0.05 / problem.unit
    assert near.sum() >= 3 and np.median(sizes[near]) * problem.unit < 0.2


def test_between_parallel_plates_cells_are_wider_than_the_gap_unless_an_edge_is_near() -> None:
    """Within half a gap of the edges the cells are smaller than the gap; in the middle they are several times as wide."""
    gap = 0.03
    problem = conductors_of([plate("s"), plate("p", (0.5, 0.5), 0, 0, gap)])
    tagged = tagged_mesh(problem, Sizing(), problem.mirror_planes, straight=True)
    corners = (
        problem.centre
        + problem.unit * tagged.mesh.geometry.x[tagged.mesh.geometry.dofmap.array.reshape(-1, 4)]
    )
    widths = np.linalg.norm(corners[:, :, None] - corners[:, None], axis=3).max(axis=(1, 2)) / gap
    middle = corners.mean(axis=1)
    to_edges = 0.5 - np.abs(middle[:, :2]).max(axis=1)
    between = (middle[:, 2] > 0) & (middle[:, 2] < gap)
    inner, outer = (widths[between & near] for near in (to_edges > 0.3, np.abs(to_edges) < gap / 2))
    print(f"\ncells over the gap: {np.median(inner):.1f} inside, {np.median(outer):.1f} at the edges")
    assert np.median(inner) > 3 and np.median(outer) < 1
