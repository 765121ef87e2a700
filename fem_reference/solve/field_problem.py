"""Laplace's equation around the conductors on one mesh: cubic elements, open boundary, charges by the energy."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from fem_reference.mesh.tagged_mesh import AWAY_FROM_EDGES, FIRST_BODY, NEAR_EDGE, OUTER_SURFACE, TaggedMesh
from fem_reference.common.stages import stage

DEGREE = 3
QUADRATURE_DEGREE_NEAR_EDGE = 10
"""On quarter-point elements the integrand is rational; degree 4 puts a point on the singular edge (NaN)."""
QUADRATURE_DEGREE = 4
"""Exact for the gradients of cubic functions on straight elements."""
CURVED_SURFACE_QUADRATURE_DEGREE = 8

COMPILATION = {"timeout": 300}
"""Seconds to wait for another process that compiles the same form: cases run side by side on a slow machine too."""

SOLVER_OPTIONS: dict[str, str | float | int] = {
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
    """(n, n): charge on conductor i with conductor j at 1 V and the others grounded; floating ones have no charge."""
    sensors_alone: NDArray[np.float64]
    """(m, m): the same for the first m conductors with everything but sensors absent."""
    unknowns: int
    potentials: list[NDArray[np.float64]]
    """For each conductor: the potential (unknowns,) with it at 1 V and the others grounded."""


class FieldProblem:
    """The stiffness matrix of one mesh, and solutions with any choice of conductors on it."""

    def __init__(
        self,
        tagged: TaggedMesh,
        conductors: Sequence[Sequence[int]],
        permittivities: Mapping[int, float] | None = None,
    ) -> None:
        """`conductors[k]` lists the bodies that make up conductor k.

        `permittivities` has those of the solid bodies that are dielectric, relative to the medium's.
        """
        self.tagged = tagged
        self.permittivities = dict(permittivities or {})
        with stage("assembling the equations"):
            self.space = fem.FunctionSpace(tagged.mesh, ("Lagrange", DEGREE), jit_params=COMPILATION)
            self.stiffness = _stiffness(tagged, self.space, self.permittivities)
        self.dofs = [_conductor_dofs(tagged, self.space, bodies) for bodies in conductors]
        self.wall_dofs = _wall_dofs(tagged, self.space)

    def without_dielectrics(self) -> FieldProblem:
        """The same conductors on the same mesh, the medium in the place of every dielectric body."""
        if not self.permittivities:
            return self
        bare = copy.copy(self)
        bare.permittivities = {}
        bare.stiffness = _stiffness(self.tagged, self.space, {})
        return bare

    @property
    def unknowns(self) -> int:
        return int(self.space.dofmap.index_map.size_global)

    def potentials(self, present: Sequence[int], driven: int) -> list[NDArray[np.float64]]:
        """For each of the first `driven` conductors: the potential (unknowns,) with it at 1 V, the other present ones at 0 V.

        Conductors that are not present are free space. Raises RuntimeError when the iteration does not converge.
        """
        with stage("solving the equations"):
            return self._potentials(present, driven)

    def _potentials(self, present: Sequence[int], count: int) -> list[NDArray[np.float64]]:
        fixed = np.unique(np.concatenate([*(self.dofs[k] for k in present), self.wall_dofs]))
        constrained = self.stiffness.copy()
        first = self.space.dofmap.index_map.local_range[0]
        constrained.zeroRowsColumns(np.asarray(fixed + first, dtype=PETSc.IntType), 1.0)
        solver = PETSc.KSP().create(constrained.comm)
        solver.setOperators(constrained)
        set_options(solver, SOLVER_OPTIONS)
        solver.setUp()
        potentials = []
        for k in present[:count]:
            driven = self.stiffness.createVecRight()
            driven.array[self.dofs[k]] = 1.0
            load = self.stiffness.createVecLeft()
            self.stiffness.mult(driven, load)
            load.scale(-1.0)
            load.array[fixed] = 0.0
            solution = self.stiffness.createVecRight()
            solver.solve(load, solution)
            require_convergence(solver)
            solution.axpy(1.0, driven)
            if not np.isfinite(solution.array).all():
                raise RuntimeError("the potential is not finite")
            potentials.append(solution.array.copy())
        solver.destroy()
        constrained.destroy()
        return potentials

    def energies(self, potentials: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
        """u_i·K·u_j (n, n) of potentials (unknowns,): the charge on conductor i with conductor j at 1 V (ε = 1).

        The same numbers as the sums of the reactions K·u_j over the conductors' unknowns, but what the iterative solver
        leaves undone enters squared.
        """
        return products(self.stiffness, potentials)


def products(matrix: PETSc.Mat, vectors: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """v_i·A·v_j (n, n) for a symmetric matrix."""
    images = []
    for vector in vectors:
        source = matrix.createVecRight()
        source.array[:] = vector
        image = matrix.createVecLeft()
        matrix.mult(source, image)
        images.append(image.array.copy())
    found = matrix.comm.tompi4py().allreduce(np.array(vectors) @ np.array(images).T)
    return np.asarray((found + found.T) / 2)


def charges(
    problem: FieldProblem, sensors: int, floating: int = 0, grounded: int = 0, grounded_sensors: int = 0
) -> Charges:
    """The Maxwell matrix on one mesh; the first `sensors` conductors also with everything but sensors absent.

    The last `grounded` conductors are never driven, the first `grounded_sensors` of them are sensors. The `floating` ones
    before carry no charge. Neither have a row in the matrix.
    """
    count = len(problem.dofs)
    driven = count - grounded
    potentials = problem.potentials(range(count), driven)
    maxwell = problem.energies(potentials)
    kept = without_floating(maxwell, floating)
    all_sensors = [*range(sensors), *range(driven, driven + grounded_sensors)]
    if sensors == 0 or (len(all_sensors) == count and not problem.permittivities):
        return Charges(kept, kept[:sensors, :sensors], problem.unknowns, potentials)
    bare = problem.without_dielectrics()
    alone = bare.energies(bare.potentials(all_sensors, sensors))
    return Charges(kept, alone, problem.unknowns, potentials)


def without_floating(maxwell: NDArray[np.float64], floating: int) -> NDArray[np.float64]:
    """The Maxwell matrix of the other conductors when the last `floating` ones carry no charge: the Schur complement.

    Solving the rows 0 = M_fk·V_k + M_ff·V_f for the floating conductors' potentials leaves M_kk − M_kf·M_ff⁻¹·M_fk.
    """
    if floating == 0:
        return maxwell
    kept = len(maxwell) - floating
    mixed = maxwell[:kept, kept:]
    induced = np.linalg.solve(maxwell[kept:, kept:], mixed.T)
    reduced = maxwell[:kept, :kept] - mixed @ induced
    return np.asarray((reduced + reduced.T) / 2)


def first_sensor_driven(problem: FieldProblem, floating: int) -> NDArray[np.float64]:
    """The potential (unknowns,) with the first conductor at 1 V, the last `floating` without charge, the others at 0 V."""
    count = len(problem.dofs)
    potentials = problem.potentials(range(count), count)
    if floating == 0:
        return potentials[0]
    maxwell = problem.energies(potentials)
    induced = np.linalg.solve(maxwell[-floating:, -floating:], -maxwell[-floating:, 0])
    return np.asarray(potentials[0] + induced @ np.array(potentials[-floating:]))


def _stiffness(
    tagged: TaggedMesh, space: fem.FunctionSpace, permittivities: Mapping[int, float]
) -> PETSc.Mat:
    """∫ε∇u·∇v over the mesh, plus the open boundary ∫ (x·n)/|x|² u v, exact for 1/|x|; ε = 1 but in dielectric bodies."""
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    dx = ufl.Measure("dx", domain=tagged.mesh, subdomain_data=tagged.near_edge)
    ds = ufl.Measure("ds", domain=tagged.mesh, subdomain_data=tagged.facets)
    near = dx(NEAR_EDGE, metadata={"quadrature_degree": QUADRATURE_DEGREE_NEAR_EDGE})
    away = dx(AWAY_FROM_EDGES, metadata={"quadrature_degree": QUADRATURE_DEGREE})
    outer = ds(OUTER_SURFACE, metadata={"quadrature_degree": CURVED_SURFACE_QUADRATURE_DEGREE})
    centre = fem.Constant(tagged.mesh, PETSc.ScalarType(tuple(tagged.centre)))
    x = ufl.SpatialCoordinate(tagged.mesh) - centre
    normal = ufl.FacetNormal(tagged.mesh)
    energy = ufl.inner(ufl.grad(u), ufl.grad(v))
    if permittivities:
        energy *= permittivity(tagged, permittivities)
    form = energy * (near + away)
    if not tagged.in_room:
        form += ufl.dot(x, normal) / ufl.dot(x, x) * u * v * outer
    matrix = assemble_matrix(fem.form(form, jit_params=COMPILATION))
    matrix.assemble()
    return matrix


def permittivity(tagged: TaggedMesh, permittivities: Mapping[int, float]) -> fem.Function:
    """The permittivity of every cell."""
    coefficient = fem.Function(fem.FunctionSpace(tagged.mesh, ("DG", 0), jit_params=COMPILATION))
    coefficient.x.array[:] = cell_permittivities(tagged, permittivities)
    return coefficient


def cell_permittivities(tagged: TaggedMesh, permittivities: Mapping[int, float]) -> NDArray[np.float64]:
    """The permittivity (cells,) relative to the medium's: 1 but in dielectric bodies."""
    values = np.ones(tagged.local_cells)
    for body, value in permittivities.items():
        values[tagged.cells.find(FIRST_BODY + body)] = value
    return values


def _conductor_dofs(tagged: TaggedMesh, space: fem.FunctionSpace, bodies: Sequence[int]) -> NDArray[np.int32]:
    found = []
    for k in bodies:
        for dimension, tags in ((2, tagged.facets), (3, tagged.cells)):
            # All processes ask, those without such entities too: the dofs of one may be on the facets of another.
            found.append(fem.locate_dofs_topological(space, dimension, tags.find(FIRST_BODY + k)))
    known = np.unique(np.concatenate(found))
    return np.asarray(known[known < space.dofmap.index_map.size_local], dtype=PETSc.IntType)


def _wall_dofs(tagged: TaggedMesh, space: fem.FunctionSpace) -> NDArray[np.int32]:
    """The unknowns on the walls of a room; none in free space."""
    walls = tagged.facets.find(OUTER_SURFACE) if tagged.in_room else np.empty(0, dtype=np.int32)
    known = fem.locate_dofs_topological(space, 2, walls)
    return np.asarray(known[known < space.dofmap.index_map.size_local], dtype=PETSc.IntType)


def release_unused(communicator: MPI.Comm) -> None:
    """Free the matrices and vectors of a mesh's communicator, and of each process by itself, that nothing refers to any more.

    petsc4py keeps what Python drops until all processes of its communicator say that they have dropped it. The communicator is the
    mesh's own: once the mesh is gone too, nobody can say so.
    """
    for scope in (communicator, MPI.COMM_SELF):
        PETSc.garbage_cleanup(scope)


def set_options(solver: PETSc.KSP, options: Mapping[str, str | float | int]) -> None:
    """Configure a solver; the process's option database, which is shared, keeps nothing of it."""
    database = PETSc.Options()
    solver.setOptionsPrefix("field_")
    for name, value in options.items():
        database[f"field_{name}"] = value
    solver.setFromOptions()
    for name in options:
        del database[f"field_{name}"]


def require_convergence(solver: PETSc.KSP) -> None:
    """Raise RuntimeError unless the last solve converged."""
    reason = solver.getConvergedReason()
    if reason < 0:
        raise RuntimeError(f"the linear solver stopped without converging (PETSc reason {reason})")
