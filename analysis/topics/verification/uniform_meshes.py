"""Uniform meshes to compare the reference with: linear or quadratic elements of one size on all conductors, not graded to edges.

Away from the conductors the elements grow as the reference's do; the outer sphere, the condition on it, the planes of symmetry, the
charges by the energy and the linear solver are the reference's own. Only the treatment of edges differs.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass

import gmsh
import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix
from dolfinx.io import gmshio
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc
from scipy.constants import epsilon_0

from fem_reference.mesh.size_function import SizeFunction
from fem_reference.mesh.sizing import distance_on_tape
from fem_reference.mesh.tape import Tape, smallest
from fem_reference.mesh.tagged_mesh import OUTER_RADIUS
from fem_reference.mesh.occ_shapes import add_ball, add_body, cut_to
from fem_reference.bodies.conductors import Conductors
from fem_reference.mesh.size_rules import Sizing
from fem_reference.solve.field_problem import SOLVER_OPTIONS, products, require_convergence, set_options
from fem_reference.bodies.symmetry import Plane, mirror_planes

Array = NDArray[np.float64]
OUTER, SPACE, FIRST = 1, 1, 10
GROWTH_OF_TIME = 4.0
"""Expected run time of a mesh relative to that of twice the element size: most elements lie along the conductors' surfaces."""
FINEST = 6
"""Largest number of halvings of the smallest body's size."""


@dataclass(frozen=True)
class UniformLevel:
    """One mesh: size of its elements on the conductors (m), unknowns, seconds, Maxwell matrix (F)."""

    size: float
    unknowns: int
    seconds: float
    maxwell: Array


def levels(problem: Conductors, degree: int, max_seconds: float) -> Iterator[UniformLevel]:
    """Solves on meshes of a half, a quarter … of the smallest body's size, as long as the next would end within `max_seconds`."""
    smallest_size = min(body.size for body in problem.bodies)
    # Compiling and loading at first use must not count for a mesh.
    solve(problem, smallest_size, degree)
    start = time.monotonic()
    for halvings in range(1, FINEST + 1):
        level = solve(problem, smallest_size / 2**halvings, degree)
        yield level
        if time.monotonic() - start + GROWTH_OF_TIME * level.seconds > max_seconds:
            return


def solve(problem: Conductors, size: float, degree: int) -> UniformLevel:
    """Returns the Maxwell matrix of conductors on one mesh; `size` is in the problem's unit."""
    start = time.monotonic()
    planes = mirror_planes(problem.bodies, problem.owner)
    gmsh.initialize(readConfigFiles=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        for source in ("ExtendFromBoundary", "FromPoints", "FromCurvature"):
            gmsh.option.setNumber(f"Mesh.MeshSize{source}", 0)
        gmsh.model.add("uniform")
        centre = _build(problem, size, planes)
        mesh, cells, facets = gmshio.model_to_mesh(gmsh.model, MPI.COMM_WORLD, 0, gdim=3)
    finally:
        gmsh.finalize()
    space = fem.FunctionSpace(mesh, ("Lagrange", degree))
    dofs = []
    for parts in problem.parts:
        found = [
            fem.locate_dofs_topological(space, dimension, tags.find(FIRST + body))
            for body in parts
            for dimension, tags in ((2, facets), (3, cells))
        ]
        dofs.append(np.unique(np.concatenate(found)).astype(PETSc.IntType))
    stiffness = _stiffness(space, facets, centre)
    matrix = products(stiffness, _potentials(stiffness, dofs))
    farads = epsilon_0 * problem.unit * 2 ** len(planes)
    unknowns = int(space.dofmap.index_map.size_global)
    return UniformLevel(size * problem.unit, unknowns, time.monotonic() - start, farads * matrix)


def _build(problem: Conductors, size: float, planes: tuple[Plane, ...]) -> Array:
    """Meshes the current gmsh model; returns the centre of its outer sphere."""
    corners = np.concatenate([body.corners for body in problem.bodies])
    centre = (corners.min(axis=0) + corners.max(axis=0)) / 2
    for plane in planes:
        centre = (centre + plane.mirrored(centre)) / 2
    radius = OUTER_RADIUS * float(np.linalg.norm(corners - centre, axis=1).max())
    ball = add_ball(centre, radius, planes)
    shapes = [add_body(body) for body in problem.bodies]
    if planes:
        shapes = cut_to(shapes, centre, radius, planes)
    _, pieces = gmsh.model.occ.fragment([ball], [entity for shape in shapes for entity in shape])
    gmsh.model.occ.synchronize()
    rest = iter(pieces[1:])
    parts = [[entity for _ in shape for entity in next(rest)] for shape in shapes]
    inside = {entity for part in parts for entity in part}
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in pieces[0] if (3, tag) not in inside], SPACE)
    for k, part in enumerate(parts):
        gmsh.model.addPhysicalGroup(part[0][0], [tag for _, tag in part], FIRST + k)
    faces = gmsh.model.getBoundary(gmsh.model.getEntities(3), combined=True, oriented=False)
    outer = [tag for _, tag in faces if _is_outer(tag, radius)]
    gmsh.model.addPhysicalGroup(2, outer, OUTER)
    tape = Tape()
    away = smallest([distance_on_tape(body, tape) for body in problem.bodies])
    sizes = SizeFunction(size + Sizing().growth * away)
    sizes.set_in_gmsh()
    gmsh.model.mesh.generate(3)
    return np.asarray(centre)


def _is_outer(face: int, radius: float) -> bool:
    far = np.max(np.abs(gmsh.model.getBoundingBox(2, face))) > 0.5 * radius
    return bool(far and gmsh.model.getType(2, face) == "Sphere")


def _stiffness(space: fem.FunctionSpace, facets: object, centre: Array) -> PETSc.Mat:
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    ds = ufl.Measure("ds", domain=space.mesh, subdomain_data=facets)(OUTER)
    x = ufl.SpatialCoordinate(space.mesh) - fem.Constant(space.mesh, PETSc.ScalarType(tuple(centre)))
    normal = ufl.FacetNormal(space.mesh)
    form = ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx
    form += ufl.dot(x, normal) / ufl.dot(x, x) * u * v * ds(metadata={"quadrature_degree": 6})
    matrix = assemble_matrix(fem.form(form))
    matrix.assemble()
    return matrix


def _potentials(stiffness: PETSc.Mat, dofs: list[NDArray[np.int32]]) -> list[Array]:
    """Returns, for each conductor, the potential with it at 1 V and the others at 0 V."""
    fixed = np.unique(np.concatenate(dofs))
    constrained = stiffness.copy()
    constrained.zeroRowsColumns(fixed, 1.0)
    solver = PETSc.KSP().create(constrained.comm)
    solver.setOperators(constrained)
    set_options(solver, SOLVER_OPTIONS)
    found = []
    for own in dofs:
        driven, load, solution = (stiffness.createVecRight() for _ in range(3))
        driven.array[own] = 1.0
        stiffness.mult(driven, load)
        load.scale(-1.0)
        load.array[fixed] = 0.0
        solver.solve(load, solution)
        require_convergence(solver)
        solution.axpy(1.0, driven)
        found.append(solution.array.copy())
    solver.destroy()
    constrained.destroy()
    return found
