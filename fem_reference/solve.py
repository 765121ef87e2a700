"""Laplace's equation around the conductors on one mesh: cubic elements, open boundary, charges by the energy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix
from numpy.typing import NDArray
from petsc4py import PETSc

from fem_reference.mesh import AWAY_FROM_EDGES, FIRST_BODY, NEAR_EDGE, OUTER_SURFACE, TaggedMesh

DEGREE = 3
QUADRATURE_DEGREE_NEAR_EDGE = 10
"""On quarter-point elements the integrand is rational; degree 4 puts a point on the singular edge (NaN)."""
QUADRATURE_DEGREE = 4
"""Exact for the gradients of cubic functions on straight elements."""
CURVED_SURFACE_QUADRATURE_DEGREE = 8

COMPILATION = {"timeout": 300}
"""Seconds to wait for another process that compiles the same form: cases run side by side on a slow machine too."""

SOLVER_OPTIONS = {
    "ksp_type": "cg",
    "ksp_rtol": 1e-6,
    "ksp_norm_type": "preconditioned",
    "pc_type": "hypre",
    "pc_hypre_type": "boomeramg",
    "pc_hypre_boomeramg_strong_threshold": 0.5,
    "pc_hypre_boomeramg_coarsen_type": "HMIS",
    "pc_hypre_boomeramg_interp_type": "ext+i",
    "pc_hypre_boomeramg_P_max": 4,
    "pc_hypre_boomeramg_agg_nl": 1,
    "pc_hypre_boomeramg_agg_num_paths": 2,
    "pc_hypre_boomeramg_relax_type_all": "Chebyshev",
}


@dataclass(frozen=True)
class Charges:
    """Charges per volt on one mesh, for ε = 1: lengths in the unit of the mesh."""

    maxwell: NDArray[np.float64]
    """(n, n): charge on conductor i with conductor j at 1 V and the others grounded."""
    sensors_alone: NDArray[np.float64]
    """(m, m): the same for the first m conductors with the others absent."""
    unknowns: int


class FieldProblem:
    """The stiffness matrix of one mesh, and solutions with any choice of conductors on it."""

    def __init__(self, tagged: TaggedMesh, conductors: Sequence[Sequence[int]]) -> None:
        """`conductors[k]` lists the bodies that make up conductor k."""
        self.space = fem.FunctionSpace(tagged.mesh, ("Lagrange", DEGREE), jit_params=COMPILATION)
        self.stiffness = _stiffness(tagged, self.space)
        self.dofs = [_conductor_dofs(tagged, self.space, bodies) for bodies in conductors]

    @property
    def unknowns(self) -> int:
        return int(self.space.dofmap.index_map.size_global)

    def potentials(self, present: Sequence[int]) -> list[NDArray[np.float64]]:
        """For each present conductor: the potential (unknowns,) with it at 1 V, the other present ones at 0 V.

        Conductors that are not present are free space. Raises RuntimeError when the iteration does not converge.
        """
        fixed = np.unique(np.concatenate([self.dofs[k] for k in present]))
        constrained = self.stiffness.copy()
        constrained.zeroRowsColumns(fixed, 1.0)
        solver = _solver(constrained)
        potentials = []
        for k in present:
            driven = self.stiffness.createVecRight()
            driven.array[self.dofs[k]] = 1.0
            load = self.stiffness.createVecLeft()
            self.stiffness.mult(driven, load)
            load.scale(-1.0)
            load.array[fixed] = 0.0
            solution = self.stiffness.createVecRight()
            solver.solve(load, solution)
            if solver.getConvergedReason() < 0:
                raise RuntimeError(
                    f"the linear solver stopped without converging (PETSc reason {solver.getConvergedReason()})"
                )
            solution.axpy(1.0, driven)
            potentials.append(solution.array.copy())
        solver.destroy()
        constrained.destroy()
        return potentials

    def energies(self, potentials: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
        """u_i·K·u_j (n, n) of potentials (unknowns,): the charge on conductor i with conductor j at 1 V (ε = 1).

        The same numbers as the sums of the reactions K·u_j over the conductors' unknowns, but what the iterative solver
        leaves undone enters squared.
        """
        stack = np.array(potentials)
        images = []
        for potential in potentials:
            source = self.stiffness.createVecRight()
            source.array[:] = potential
            image = self.stiffness.createVecLeft()
            self.stiffness.mult(source, image)
            images.append(image.array.copy())
        products = stack @ np.array(images).T
        return np.asarray((products + products.T) / 2)


def charges(problem: FieldProblem, sensors: int) -> Charges:
    """The Maxwell matrix on one mesh; the first `sensors` conductors also with all others absent."""
    potentials = problem.potentials(range(len(problem.dofs)))
    maxwell = problem.energies(potentials)
    if sensors in (0, len(problem.dofs)):
        return Charges(maxwell, maxwell[:sensors, :sensors], problem.unknowns)
    return Charges(maxwell, problem.energies(problem.potentials(range(sensors))), problem.unknowns)


def _stiffness(tagged: TaggedMesh, space: fem.FunctionSpace) -> PETSc.Mat:
    """∫∇u·∇v over the mesh, plus the open boundary ∫ (x·n)/|x|² u v, exact for 1/|x|."""
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    dx = ufl.Measure("dx", domain=tagged.mesh, subdomain_data=tagged.near_edge)
    ds = ufl.Measure("ds", domain=tagged.mesh, subdomain_data=tagged.facets)
    near = dx(NEAR_EDGE, metadata={"quadrature_degree": QUADRATURE_DEGREE_NEAR_EDGE})
    away = dx(AWAY_FROM_EDGES, metadata={"quadrature_degree": QUADRATURE_DEGREE})
    outer = ds(OUTER_SURFACE, metadata={"quadrature_degree": CURVED_SURFACE_QUADRATURE_DEGREE})
    centre = fem.Constant(tagged.mesh, PETSc.ScalarType(tuple(tagged.centre)))
    x = ufl.SpatialCoordinate(tagged.mesh) - centre
    normal = ufl.FacetNormal(tagged.mesh)
    form = ufl.inner(ufl.grad(u), ufl.grad(v)) * (near + away)
    form += ufl.dot(x, normal) / ufl.dot(x, x) * u * v * outer
    matrix = assemble_matrix(fem.form(form, jit_params=COMPILATION))
    matrix.assemble()
    return matrix


def _conductor_dofs(tagged: TaggedMesh, space: fem.FunctionSpace, bodies: Sequence[int]) -> NDArray[np.int32]:
    found = []
    for k in bodies:
        for dimension, tags in ((2, tagged.facets), (3, tagged.cells)):
            entities = tags.find(FIRST_BODY + k)
            if len(entities):
                found.append(fem.locate_dofs_topological(space, dimension, entities))
    return np.asarray(np.unique(np.concatenate(found)), dtype=PETSc.IntType)


def _solver(matrix: PETSc.Mat) -> PETSc.KSP:
    solver = PETSc.KSP().create(matrix.comm)
    solver.setOptionsPrefix("field_")
    options = PETSc.Options()
    for name, value in SOLVER_OPTIONS.items():
        options[f"field_{name}"] = value
    solver.setOperators(matrix)
    solver.setFromOptions()
    solver.setUp()
    return solver
