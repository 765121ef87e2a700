"""Laplace's equation around the conductors on one mesh: cubic Lagrange elements, an open boundary, charges from the energy."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix
from mpi4py import MPI
from petsc4py import PETSc

from fem_reference.bodies.conductors import Conductors
from fem_reference.mesh.distributed import from_owners
from fem_reference.mesh.tagged_mesh import AWAY_FROM_EDGES, FIRST_BODY, NEAR_EDGE, OUTER_SURFACE, TaggedMesh
from fem_reference.common.limits import stage
from geometries.common.arrays import Array, Integers

Fields = Sequence[Array] | Array
"""Potentials (unknowns,), or other values, of several solutions."""
DEGREE = 3
"""Degree of the Lagrange elements."""
QUADRATURE_DEGREE_NEAR_EDGE = 10
"""Quadrature degree on quarter-point elements, where the integrand is rational. Degree 4 would put a point on the singular edge and
give NaN."""
QUADRATURE_DEGREE = 4
"""Quadrature degree that is exact for products of gradients of cubic functions on straight elements."""
CURVED_SURFACE_QUADRATURE_DEGREE = 8
"""Quadrature degree on the faces of the outer sphere."""

COMPILATION = {"timeout": 300}
"""Seconds to wait for another process that compiles the same form. It has to be enough for cases that run side by side on a slow
machine."""

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
    """Charges per volt on one mesh, for ε = 1, in the mesh's unit of length."""

    maxwell: Array
    """(n, n): charge on conductor i with conductor j at 1 V and the others grounded; floating conductors carry no charge."""
    sensors_alone: Array
    """(m, m): the same for the first m conductors in a scene of the sensors alone."""
    unknowns: int
    potentials: list[Array]
    """For each driven conductor the potential (unknowns,) with this conductor at 1 V and the others grounded."""
    potentials_alone: list[Array] | None = None
    """For each of the first m conductors the same in a scene of the sensors alone; None if that is the scene."""


class FieldProblem:
    """The stiffness matrix of one mesh, with solutions for any choice of the conductors on it."""

    def __init__(self, tagged: TaggedMesh, problem: Conductors) -> None:
        """Assemble the matrix of these conductors and dielectric bodies on their mesh."""
        self.tagged = tagged
        self.permittivities = problem.permittivities
        # The mesh has this share of the conductors, and so of what connects them to ground.
        self.to_ground = np.asarray(problem.to_ground, dtype=np.float64) / tagged.copies
        with stage("assembling the equations"):
            self.space = fem.FunctionSpace(tagged.mesh, ("Lagrange", DEGREE), jit_params=COMPILATION)
            self.stiffness = _stiffness(tagged, self.space, self.permittivities)
        self.dofs = [_conductor_dofs(tagged, self.space, bodies) for bodies in problem.parts]
        self.wall_dofs = _wall_dofs(tagged, self.space)

    def with_dielectrics(self, permittivities: Mapping[int, float]) -> FieldProblem:
        """The same conductors on the same mesh, with these dielectric bodies only; the medium is in the place of the others."""
        if self.permittivities == permittivities:
            return self
        bare = copy.copy(self)
        bare.permittivities = dict(permittivities)
        bare.stiffness = _stiffness(self.tagged, self.space, permittivities)
        return bare

    def with_conductors(self, numbers: Sequence[int], to_ground: Array) -> FieldProblem:
        """The same mesh with these of the conductors only, in this order; `to_ground` is that of those among them that float."""
        fewer = copy.copy(self)
        fewer.dofs = [self.dofs[k] for k in numbers]
        fewer.to_ground = to_ground
        return fewer

    @property
    def unknowns(self) -> int:
        return int(self.space.dofmap.index_map.size_global)

    def potentials(self, present: Sequence[int], driven: int) -> list[Array]:
        """Solve for one potential (unknowns,) for each of the first `driven` of the `present` conductors.

        That conductor is at 1 V, the other present ones are at 0 V, and absent conductors are free space. Raises RuntimeError when
        the iteration does not converge.
        """
        with stage("solving the equations"):
            return self._potentials(present, driven)

    def _potentials(self, present: Sequence[int], count: int) -> list[Array]:
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

    def with_ghosts(self, potentials: Sequence[Array]) -> Array:
        """Potentials (n, unknowns) with the unknowns of other processes that this one's cells have; they come last."""
        unknowns = self.space.dofmap.index_map
        own = np.zeros((len(potentials), unknowns.size_local + unknowns.num_ghosts))
        own[:, : unknowns.size_local] = potentials
        return np.array([from_owners(unknowns, each) for each in own]).reshape(own.shape)

    def energies(self, potentials: Fields) -> Array:
        """The products u_i·K·u_j (n, n) of potentials (unknowns,): the charge on conductor i with conductor j at 1 V (ε = 1).

        They equal the sums of the reactions K·u_j over the conductors' unknowns, except that the error of the iterative solver
        enters squared.
        """
        comm = self.stiffness.comm.tompi4py()
        found = comm.allreduce(np.array(potentials) @ self.reactions(potentials).T)
        return np.asarray((found + found.T) / 2)

    def reactions(self, potentials: Fields) -> Array:
        """The products K·u_j (n, unknowns) for this process's unknowns."""
        images = []
        for potential in potentials:
            source, image = self.stiffness.createVecRight(), self.stiffness.createVecLeft()
            source.array[:] = potential
            self.stiffness.mult(source, image)
            images.append(image.array.copy())
        return np.array(images)


def charges(
    problem: FieldProblem, sensors: int, floating: int = 0, grounded: int = 0, grounded_sensors: int = 0
) -> Charges:
    """Solve for the Maxwell matrix on one mesh, and for that of the sensors alone.

    The first `sensors` conductors are sensors. The last `grounded` conductors are never driven, and the first `grounded_sensors` of
    them are sensors too. The `floating` conductors, which come before the grounded ones, carry no charge. Neither kind has a row in
    the matrix.
    """
    count = len(problem.dofs)
    driven = count - grounded
    potentials = problem.potentials(range(count), driven)
    maxwell = problem.energies(potentials)
    kept = without_floating(maxwell, floating, problem.to_ground)
    all_sensors = [*range(sensors), *range(driven, driven + grounded_sensors)]
    if sensors == 0 or (len(all_sensors) == count and not problem.permittivities):
        return Charges(kept, kept[:sensors, :sensors], problem.unknowns, potentials)
    bare = problem.with_dielectrics({})
    alone = bare.potentials(all_sensors, sensors)
    return Charges(kept, bare.energies(alone), problem.unknowns, potentials, alone)


def without_floating(maxwell: Array, floating: int, to_ground: Sequence[float] | Array = ()) -> Array:
    """Eliminate the last `floating` conductors, which carry no charge, from the Maxwell matrix: its Schur complement.

    With `to_ground`, in the matrix's unit, each of them carries the opposite of the charge on its capacitance to ground, which adds to
    its own entry first. Solving the rows 0 = M_fk·V_k + M_ff·V_f for the floating conductors' potentials leaves M_kk − M_kf·M_ff⁻¹·M_fk.
    """
    if floating == 0:
        return maxwell
    kept = len(maxwell) - floating
    reduced = maxwell[:kept, :kept] + maxwell[:kept, kept:] @ _induced(maxwell, floating, to_ground)
    return np.asarray((reduced + reduced.T) / 2)


def with_floating(
    fields: Array, maxwell: Array, floating: int, to_ground: Sequence[float] | Array = ()
) -> Array:
    """The fields (kept, …) with one conductor at 1 V and the last `floating` ones left to themselves, from those (n, …) with these at 0 V too."""
    if floating == 0:
        return fields
    kept = len(maxwell) - floating
    return fields[:kept] + np.tensordot(_induced(maxwell, floating, to_ground).T, fields[kept:], axes=1)


def _induced(maxwell: Array, floating: int, to_ground: Sequence[float] | Array) -> Array:
    """The potentials (floating, kept) of the last `floating` conductors of a Maxwell matrix per volt on each of the others."""
    kept = len(maxwell) - floating
    own = maxwell[kept:, kept:]
    own = own + np.diag(to_ground) if len(to_ground) else own
    return np.asarray(np.linalg.solve(own, -maxwell[kept:, :kept]))


def first_sensor_driven(problem: FieldProblem, floating: int) -> Array:
    """The potential (unknowns,) with the first conductor at 1 V, the last `floating` ones uncharged, and the others at 0 V."""
    count = len(problem.dofs)
    potentials = np.array(problem.potentials(range(count), count))
    found = with_floating(potentials, problem.energies(potentials), floating, problem.to_ground)
    return np.asarray(found[0])


def _stiffness(
    tagged: TaggedMesh, space: fem.FunctionSpace, permittivities: Mapping[int, float]
) -> PETSc.Mat:
    """Assemble ∫ε∇u·∇v over the mesh plus, without a room, the open boundary ∫ (x·n)/|x|² u v, which is exact for 1/|x|.

    ε is 1 outside of dielectric bodies.
    """
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
    """The permittivity relative to the medium's, as a function that is constant in every cell."""
    coefficient = fem.Function(fem.FunctionSpace(tagged.mesh, ("DG", 0), jit_params=COMPILATION))
    coefficient.x.array[:] = cell_permittivities(tagged, permittivities)
    return coefficient


def cell_permittivities(tagged: TaggedMesh, permittivities: Mapping[int, float]) -> Array:
    """The permittivity (cells,) relative to the medium's: 1 outside of dielectric bodies."""
    values = np.ones(tagged.local_cells)
    for body, value in permittivities.items():
        values[tagged.cells.find(FIRST_BODY + body)] = value
    return values


def _conductor_dofs(tagged: TaggedMesh, space: fem.FunctionSpace, bodies: Sequence[int]) -> Integers:
    """This process's unknowns on, and inside of, the bodies of one conductor."""
    found = []
    for k in bodies:
        for dimension, tags in ((2, tagged.facets), (3, tagged.cells)):
            # The call is collective, and the unknowns of one process may lie on the facets of another: processes without such
            # entities must take part.
            found.append(fem.locate_dofs_topological(space, dimension, tags.find(FIRST_BODY + k)))
    known = np.unique(np.concatenate(found))
    return np.asarray(known[known < space.dofmap.index_map.size_local], dtype=PETSc.IntType)


def _wall_dofs(tagged: TaggedMesh, space: fem.FunctionSpace) -> Integers:
    """This process's unknowns on the walls of a room; none in free space."""
    walls = tagged.facets.find(OUTER_SURFACE) if tagged.in_room else np.empty(0, dtype=np.int32)
    known = fem.locate_dofs_topological(space, 2, walls)
    return np.asarray(known[known < space.dofmap.index_map.size_local], dtype=PETSc.IntType)


def release_unused(communicator: MPI.Comm) -> None:
    """Free the unreferenced PETSc matrices and vectors of a mesh's communicator, and those of each process by itself.

    petsc4py keeps an object that Python has dropped until all processes of the object's communicator confirm that they have dropped
    it too. The communicator is the mesh's own, so that this must be called while the mesh still exists.
    """
    for scope in (communicator, MPI.COMM_SELF):
        PETSc.garbage_cleanup(scope)


def set_options(solver: PETSc.KSP, options: Mapping[str, str | float | int]) -> None:
    """Configure a solver, and remove its options from PETSc's shared option database afterwards."""
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
