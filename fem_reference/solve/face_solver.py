"""The hybridised system for the multipliers on the faces, solved by preconditioned conjugate gradients.

A multiplier is one polynomial on each face, and acts as a potential there. The preconditioner has two levels: the diagonal blocks of
all faces, and a coarse space of the continuous potentials that are linear in every cell. The coarse space is small, its values on
the faces are multipliers, and the errors that it cannot represent are local to a face: 20 to 40 iterations are enough on any mesh.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import dolfinx
import numpy as np
import scipy.sparse
from dolfinx.cpp.common import IndexMap
from mpi4py import MPI
from petsc4py import PETSc

from fem_reference.mesh.distributed import from_owners, gathered, numbered, summed, whole_numbers
from fem_reference.solve.reference_flux import face_polynomials, polynomials_on_face
from fem_reference.solve.field_problem import require_convergence, set_options
from geometries.common.arrays import Array, Flags, Indices, Integers

SOLVER_OPTIONS: dict[str, str | float | int] = {
    "ksp_type": "cg",
    # The error left in an energy is the square of the error of the multipliers: 1e-9 of it, 1e-7 with the safety below.
    "ksp_rtol": 3e-5,
    "ksp_norm_type": "natural",
    "ksp_max_it": 500,
    "mg_levels_ksp_type": "chebyshev",
    "mg_levels_ksp_max_it": 2,
    "mg_levels_pc_type": "pbjacobi",
    "mg_coarse_ksp_type": "preonly",
    "mg_coarse_pc_type": "hypre",
    "mg_coarse_pc_hypre_type": "boomeramg",
}

ALGEBRAIC_SAFETY = 100
"""Factor on the square of the preconditioned residual, which is the energy of the iteration's remaining error up to the quality of
the preconditioner. The factor covers a preconditioner that removes only a hundredth of an error's energy, far worse than observed."""

FACES_AT_A_TIME = 20_000
"""Number of faces whose rows are multiplied at a time: they take some tens of megabytes."""

KERNEL = 1e-9
"""Eigenvalues of a face's block below this fraction of its largest are rounding noise. Such a multiplier tests a flow that is always
zero, as between two quarter-point elements at a vertex on the edge. The smallest other eigenvalues met are 1e-3 of the largest."""


@dataclass(frozen=True)
class FaceSolution:
    """Multipliers (faces, m), and a bound on the energy of the error that the iteration left in them."""

    potentials: Array
    energy_left: float


@dataclass(frozen=True)
class CellForms:
    """Condensed quadratic forms of cells with k faces each."""

    forms: Array
    """(n, k·m, k·m)"""
    faces: Integers
    """(n, k): the numbers of the faces on this process."""
    own: int
    """Number of the forms, the first ones, that belong to this process. The others are those of its ghost cells."""


class FaceSystem:
    """The sum of the cells' condensed quadratic forms, in which the multipliers on some faces are prescribed (Dirichlet).

    Every process has the rows of the faces that it owns, both of whose cells it holds.
    """

    def __init__(
        self, mesh: dolfinx.mesh.Mesh, parts: Sequence[CellForms], fixed: Integers, degree: int
    ) -> None:
        """Assemble the system; the multipliers on the faces `fixed` are prescribed."""
        self.parts = parts
        self.per_face = face_polynomials(degree)
        self._faces, self._comm = mesh.topology.index_map(2), mesh.comm
        self.face_count = self._faces.size_local + self._faces.num_ghosts
        used = np.zeros(self.face_count, dtype=bool)
        for part in parts:
            used[part.faces.ravel()] = True
        used[fixed] = False
        numbers, self._own = numbered(self._faces, self._comm, used)
        free = np.flatnonzero(used)
        self.free = free[: self._own]
        local = np.full(self.face_count, -1)
        local[free] = np.arange(len(free))
        matrix = _with_regular_blocks(_assembled(parts, local, self._own, len(free)))
        face_vertices = _face_vertices(mesh)
        vertices = mesh.topology.index_map(0)
        is_free = _free_vertices(vertices, face_vertices, self._faces.size_local, used, fixed)
        of_vertices, own_vertices = numbered(vertices, self._comm, is_free)
        coarse = _coarse_space(face_vertices[free], is_free, degree)
        columns = of_vertices[is_free]
        product = _galerkin_product(matrix, coarse)
        self._coarse_matrix = _petsc_sum(product, columns, own_vertices, self._comm)
        self._matrix = _petsc_block_matrix(matrix, numbers[free], self._comm)
        own_rows = coarse[: self._own * self.per_face]
        self._coarse = _petsc_matrix(own_rows, columns, own_vertices, self._comm)
        self._solver = self._two_level_solver()

    def solve(self, driven: Integers, guess: Array) -> FaceSolution:
        """Solve for the multipliers with these fixed faces at potential 1 and the other fixed ones at 0, from a guess (faces, m).

        Raises RuntimeError when the iteration does not converge.
        """
        potentials = np.zeros((self.face_count, self.per_face))
        potentials[driven] = 1
        load, solution = self._matrix.createVecLeft(), self._matrix.createVecRight()
        load.array[:] = -self._applied(potentials, False)[self.free].ravel()
        solution.array[:] = guess[self.free].ravel()
        self._solver.setInitialGuessNonzero(True)
        self._solver.solve(load, solution)
        require_convergence(self._solver)
        potentials[self.free] = solution.array.reshape(-1, self.per_face)
        potentials = from_owners(self._faces, potentials)
        return FaceSolution(potentials, ALGEBRAIC_SAFETY * self._solver.getResidualNorm() ** 2)

    def energies(self, potentials: Sequence[Array]) -> Array:
        """The values (n, n) of the quadratic form for pairs of n sets of multipliers (faces, m)."""
        images = [self._applied(own, True) for own in potentials]
        found = self._comm.allreduce(np.array([[np.vdot(a, image) for image in images] for a in potentials]))
        return np.asarray((found + found.T) / 2)

    def _applied(self, potentials: Array, only_own: bool) -> Array:
        """The product of the matrix of all faces, fixed ones too, with multipliers (faces, m).

        With `only_own` it is that of the process's own cells, so that the sum over the processes is the product. Without, the rows of its own faces are whole.
        """
        image = np.zeros_like(potentials)
        for part in self.parts:
            cells = slice(part.own if only_own else None)
            faces = part.faces[cells]
            forms = part.forms[cells]
            local = potentials[faces].reshape(len(faces), forms.shape[1], 1)
            flows = (forms @ local).reshape(*faces.shape, self.per_face)
            for k in range(self.per_face):
                image[:, k] += np.bincount(faces.ravel(), flows[:, :, k].ravel(), minlength=self.face_count)
        return image

    def _two_level_solver(self) -> PETSc.KSP:
        """Conjugate gradients with the two-level preconditioner."""
        solver = PETSc.KSP().create(self._matrix.comm)
        solver.setOperators(self._matrix)
        preconditioner = solver.getPC()
        preconditioner.setType("mg")
        preconditioner.setMGLevels(2)
        preconditioner.setMGInterpolation(1, self._coarse)
        preconditioner.getMGCoarseSolve().setOperators(self._coarse_matrix)
        set_options(solver, SOLVER_OPTIONS)
        solver.setUp()
        return solver


def _assembled(
    parts: Sequence[CellForms], local: Indices, rows: int, columns: int
) -> scipy.sparse.bsr_matrix:
    """Assemble the forms into a block matrix of the first `rows` by the first `columns` free faces; faces numbered −1 are not free."""
    keys, blocks = [], []
    for part in parts:
        faces = local[part.faces]
        each = faces.shape[1]
        per_face = part.forms.shape[1] // each
        split = part.forms.reshape(-1, each, per_face, each, per_face).transpose(0, 1, 3, 2, 4)
        row, column = np.repeat(faces, each, axis=1), np.tile(faces, (1, each))
        kept = (row >= 0) & (row < rows) & (column >= 0)
        keys.append((row * columns + column)[kept])
        blocks.append(split.reshape(len(faces), each * each, per_face, per_face)[kept])
        # The largest arrays of a level are freed as soon as they are copied.
        del split
    key, block = np.concatenate(keys), np.concatenate(blocks)
    del keys, blocks
    order = np.argsort(key, kind="stable")
    places, starts, times = np.unique(key[order], return_index=True, return_counts=True)
    summed = block[order[starts]]
    # A face belongs to two cells, and a pair of different faces to one.
    twice = times == 2
    summed[twice] += block[order[starts[twice] + 1]]
    del key, block, order
    pointers = np.searchsorted(places // columns, np.arange(rows + 1))
    size = summed.shape[1]
    return scipy.sparse.bsr_matrix((summed, places % columns, pointers), shape=(rows * size, columns * size))


def _with_regular_blocks(matrix: scipy.sparse.bsr_matrix) -> scipy.sparse.bsr_matrix:
    """Make the diagonal block of every face regular: replace its zero eigenvalues by its largest one.

    The whole form is positive semidefinite, so that the kernel of a diagonal block is in the kernel of the whole matrix. Solutions and
    energies therefore do not change.
    """
    rows = np.repeat(np.arange(len(matrix.indptr) - 1), np.diff(matrix.indptr))
    diagonal = np.flatnonzero(rows == matrix.indices)
    values, vectors = np.linalg.eigh(matrix.data[diagonal])
    missing = np.where(values < KERNEL * values[:, -1:], values[:, -1:], 0)
    matrix.data[diagonal] += (vectors * missing[:, None, :]) @ vectors.transpose(0, 2, 1)
    return matrix


def _face_vertices(mesh: dolfinx.mesh.Mesh) -> Indices:
    """The vertices (faces, 3) of each face, in the order of their numbers in the whole mesh."""
    vertices = mesh.topology.connectivity(2, 0).array.reshape(-1, 3)
    order = np.argsort(whole_numbers(mesh.topology.index_map(0))[vertices], axis=1)
    return np.asarray(np.take_along_axis(vertices, order, axis=1), dtype=np.int64)


def _free_vertices(
    vertices: IndexMap, face_vertices: Indices, own: int, used: Flags, fixed: Integers
) -> Flags:
    """Which of the vertices (n,) that this process holds are on a free face, and on no fixed one, of any process.

    `used` (faces,) tells which faces are free; the first `own` faces belong to this process.
    """
    count = vertices.size_local + vertices.num_ghosts
    on_free, on_fixed = np.zeros(count), np.zeros(count)
    on_free[face_vertices[:own][used[:own]].ravel()] = 1
    on_fixed[face_vertices[fixed].ravel()] = 1
    touched = summed(vertices, np.column_stack([on_free, on_fixed]))
    return np.asarray((touched[:, 0] > 0) & (touched[:, 1] == 0))


def _coarse_space(face_vertices: Indices, is_free: Flags, degree: int) -> scipy.sparse.csr_matrix:
    """The coarse space (unknowns, vertices): values on the free faces (n, 3) of the hat function of each free vertex.

    A hat function is 1 at its vertex, 0 at the others, and linear in every cell.
    """
    points = polynomials_on_face(degree).points
    barycentric = np.column_stack([1 - points.sum(axis=1), points])
    number = np.cumsum(is_free) - 1
    unknowns = len(face_vertices) * len(points)
    rows = np.repeat(np.arange(unknowns), 3)
    columns = np.repeat(face_vertices, len(points), axis=0).ravel()
    values = np.tile(barycentric.ravel(), len(face_vertices))
    kept = is_free[columns] & (values != 0)
    return scipy.sparse.csr_matrix(
        (values[kept], (rows[kept], number[columns[kept]])), shape=(unknowns, int(is_free.sum()))
    )


def _galerkin_product(
    matrix: scipy.sparse.bsr_matrix, coarse: scipy.sparse.csr_matrix
) -> scipy.sparse.csr_matrix:
    """The product CᵀAC of a block matrix A and the coarse space C, some rows at a time: the whole of A without blocks takes half as much
    memory again as with them."""
    size, pointers = matrix.blocksize[0], matrix.indptr
    found = scipy.sparse.csr_matrix((coarse.shape[1], coarse.shape[1]))
    for start in range(0, len(pointers) - 1, FACES_AT_A_TIME):
        own = pointers[start : start + FACES_AT_A_TIME + 1]
        entries = slice(own[0], own[-1])
        shape = (size * (len(own) - 1), matrix.shape[1])
        rows = scipy.sparse.bsr_matrix(
            (matrix.data[entries], matrix.indices[entries], own - own[0]), shape=shape
        )
        at = slice(size * start, size * start + shape[0])
        found += coarse[at].T @ (rows.tocsr() @ coarse)
    return found.tocsr()


def _petsc_block_matrix(matrix: scipy.sparse.bsr_matrix, numbers: Indices, comm: MPI.Intracomm) -> PETSc.Mat:
    """Copy the rows of this process to a block matrix of all; `numbers` (n,) are those of the blocks' columns in the whole matrix."""
    size = matrix.shape[0]
    pointers, columns = matrix.indptr.astype(PETSc.IntType), numbers[matrix.indices].astype(PETSc.IntType)
    return PETSc.Mat().createBAIJ(
        size=((size, None), (size, None)),
        bsize=matrix.blocksize[0],
        csr=(pointers, columns, matrix.data),
        comm=comm,
    )


def _petsc_matrix(
    matrix: scipy.sparse.csr_matrix, numbers: Indices, columns: int, comm: MPI.Intracomm
) -> PETSc.Mat:
    """Copy the rows of this process to a matrix of all; `numbers` are those of its columns, of which the process owns some `columns`."""
    pointers, places = matrix.indptr.astype(PETSc.IntType), numbers[matrix.indices].astype(PETSc.IntType)
    return PETSc.Mat().createAIJ(
        size=((matrix.shape[0], None), (columns, None)), csr=(pointers, places, matrix.data), comm=comm
    )


def _petsc_sum(part: scipy.sparse.csr_matrix, numbers: Indices, own: int, comm: MPI.Intracomm) -> PETSc.Mat:
    """The square matrix that is the sum of the parts of all processes; `numbers` are those of a part's rows and columns in it, of which
    the process owns some `own`."""
    entries = part.tocoo()
    rows, columns, values = numbers[entries.row], numbers[entries.col], entries.data
    first = comm.scan(own) - own
    others = (rows < first) | (rows >= first + own)
    rows, columns, values = (
        np.concatenate([each[~others], gathered(comm, each[others])]) for each in (rows, columns, values)
    )
    kept = (rows >= first) & (rows < first + own)
    whole = comm.allreduce(own)
    found = scipy.sparse.coo_matrix(
        (values[kept], (rows[kept] - first, columns[kept])), shape=(own, whole)
    ).tocsr()
    return _petsc_matrix(found, np.arange(whole), own, comm)
