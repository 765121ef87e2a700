"""The hybridised system for the multipliers on the faces, solved by preconditioned conjugate gradients.

A multiplier is one polynomial on each face, and acts as a potential there. The preconditioner has two levels: the diagonal blocks of
all faces, and a coarse space of the continuous potentials that are linear in every cell. The coarse space is small, its values on
the faces are multipliers, and the errors that it cannot represent are local to a face: 20 to 40 iterations are enough on any mesh.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse
from numpy.typing import NDArray
from petsc4py import PETSc

from fem_reference.solve.reference_flux import face_polynomials, polynomials_on_face
from fem_reference.solve.field_problem import require_convergence, set_options

Array = NDArray[np.float64]
Integers = NDArray[np.int32]

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


class FaceSystem:
    """The sum of the cells' condensed quadratic forms, in which the multipliers on some faces are prescribed (Dirichlet)."""

    def __init__(
        self, parts: Sequence[tuple[Array, Integers]], face_vertices: Integers, fixed: Integers, degree: int
    ) -> None:
        """Assemble the system from `parts`: quadratic forms (n, k·m, k·m) of cells with k faces each, and these faces (n, k).

        The vertices of each face in `face_vertices` (faces, 3) are in ascending order. The multipliers on the faces `fixed` are
        prescribed.
        """
        self.parts = parts
        self.per_face = face_polynomials(degree)
        self.face_count = len(face_vertices)
        used = np.zeros(self.face_count, dtype=bool)
        for _, faces in parts:
            used[faces.ravel()] = True
        used[fixed] = False
        self.free = np.flatnonzero(used)
        number = np.full(self.face_count, -1)
        number[self.free] = np.arange(len(self.free))
        matrix = _with_regular_blocks(
            _assembled([(forms, number[faces]) for forms, faces in parts], len(self.free))
        )
        coarse = _coarse_space(face_vertices, self.free, fixed, degree)
        self._coarse_matrix = _petsc_matrix(_galerkin_product(matrix, coarse))
        self._matrix, self._coarse = _petsc_block_matrix(matrix), _petsc_matrix(coarse)
        self._solver = self._two_level_solver()

    @property
    def unknowns(self) -> int:
        return len(self.free) * self.per_face

    def solve(self, driven: Integers, guess: Array) -> FaceSolution:
        """Solve for the multipliers with these fixed faces at potential 1 and the other fixed ones at 0, from a guess (faces, m).

        Raises RuntimeError when the iteration does not converge.
        """
        potentials = np.zeros((self.face_count, self.per_face))
        potentials[driven] = 1
        load, solution = self._matrix.createVecLeft(), self._matrix.createVecRight()
        load.array[:] = -self._applied(potentials)[self.free].ravel()
        solution.array[:] = guess[self.free].ravel()
        self._solver.setInitialGuessNonzero(True)
        self._solver.solve(load, solution)
        require_convergence(self._solver)
        potentials[self.free] = solution.array.reshape(-1, self.per_face)
        return FaceSolution(potentials, ALGEBRAIC_SAFETY * self._solver.getResidualNorm() ** 2)

    def energies(self, potentials: Sequence[Array]) -> Array:
        """The values (n, n) of the quadratic form for pairs of n sets of multipliers (faces, m)."""
        images = [self._applied(own) for own in potentials]
        found = np.array([[np.vdot(a, image) for image in images] for a in potentials])
        return np.asarray((found + found.T) / 2)

    def _applied(self, potentials: Array) -> Array:
        """The product of the matrix of all faces, fixed ones too, with multipliers (faces, m)."""
        image = np.zeros_like(potentials)
        for forms, faces in self.parts:
            local = potentials[faces].reshape(len(faces), -1, 1)
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


def _assembled(parts: Sequence[tuple[Array, NDArray[np.int64]]], count: int) -> scipy.sparse.bsr_matrix:
    """Assemble the forms into a block matrix over the `count` free faces; faces numbered −1 are not free."""
    keys, blocks = [], []
    for forms, faces in parts:
        each = faces.shape[1]
        per_face = forms.shape[1] // each
        split = forms.reshape(-1, each, per_face, each, per_face).transpose(0, 1, 3, 2, 4)
        rows, columns = np.repeat(faces, each, axis=1), np.tile(faces, (1, each))
        kept = (rows >= 0) & (columns >= 0)
        keys.append((rows * count + columns)[kept])
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
    pointers = np.searchsorted(places // count, np.arange(count + 1))
    size = count * summed.shape[1]
    return scipy.sparse.bsr_matrix((summed, places % count, pointers), shape=(size, size))


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


def _coarse_space(
    face_vertices: Integers, free: NDArray[np.int64], fixed: Integers, degree: int
) -> scipy.sparse.csr_matrix:
    """The coarse space (unknowns, vertices): values on the free faces of the hat function of each free vertex.

    A hat function is 1 at its vertex, 0 at the others, and linear in every cell.
    """
    points = polynomials_on_face(degree).points
    barycentric = np.column_stack([1 - points.sum(axis=1), points])
    is_free = np.zeros(face_vertices.max() + 1, dtype=bool)
    is_free[face_vertices[free].ravel()] = True
    is_free[face_vertices[fixed].ravel()] = False
    number = np.cumsum(is_free) - 1
    unknowns = len(free) * len(points)
    rows = np.repeat(np.arange(unknowns), 3)
    columns = np.repeat(face_vertices[free], len(points), axis=0).ravel()
    values = np.tile(barycentric.ravel(), len(free))
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


def _petsc_block_matrix(matrix: scipy.sparse.bsr_matrix) -> PETSc.Mat:
    """Copy a block matrix to PETSc."""
    pointers, columns = matrix.indptr.astype(PETSc.IntType), matrix.indices.astype(PETSc.IntType)
    return PETSc.Mat().createBAIJ(
        size=matrix.shape,
        bsize=matrix.blocksize[0],
        csr=(pointers, columns, matrix.data),
        comm=PETSc.COMM_SELF,
    )


def _petsc_matrix(matrix: scipy.sparse.csr_matrix) -> PETSc.Mat:
    """Copy a sparse matrix without blocks to PETSc."""
    pointers, columns = matrix.indptr.astype(PETSc.IntType), matrix.indices.astype(PETSc.IntType)
    return PETSc.Mat().createAIJ(
        size=matrix.shape, csr=(pointers, columns, matrix.data), comm=PETSc.COMM_SELF
    )
