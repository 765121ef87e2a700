"""The equations of the potentials on the faces, one polynomial a face, solved by conjugate gradients.

Preconditioned by two levels: all faces, block by block, and the continuous potentials that are linear in every cell. These
are few, their values on the faces are among the multipliers, and what they cannot represent is local to a face: 20 to
40 iterations whatever the mesh.
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
    "ksp_rtol": 1e-8,
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
"""The square of the preconditioned residual is the energy of what the iteration leaves, up to the preconditioner's quality:
one that removes only a hundredth of an error's energy, far worse than observed, is within this factor."""

KERNEL = 1e-9
"""Eigenvalues of a face's block below this fraction of its largest are rounding: nothing can flow that this multiplier
tests, as between two quarter-point elements at a vertex of the edge. The smallest others met are 1e-3 of the largest."""


@dataclass(frozen=True)
class FaceSolution:
    """Multipliers (faces, m), and a bound on the energy that the iteration left of them."""

    potentials: Array
    energy_left: float


class FaceSystem:
    """The sum of the cells' quadratic forms of the multipliers on their faces; those on some faces are given."""

    def __init__(
        self, parts: Sequence[tuple[Array, Integers]], face_vertices: Integers, fixed: Integers, degree: int
    ) -> None:
        """`parts` are forms (n, k·m, k·m) of cells with faces (n, k) each; `face_vertices` (faces, 3) are ascending."""
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
        matrix = _without_kernels(
            _assembled([(forms, number[faces]) for forms, faces in parts], len(self.free))
        )
        coarse = _linear_potentials(face_vertices, self.free, fixed, degree)
        self._matrix, self._coarse = _blocked(matrix), _unblocked(coarse)
        self._coarse_matrix = _unblocked((coarse.T @ (matrix.tocsr() @ coarse)).tocsr())
        self._solver = self._prepared()

    @property
    def unknowns(self) -> int:
        return len(self.free) * self.per_face

    def solve(self, driven: Integers) -> FaceSolution:
        """The multipliers with these fixed faces at potential 1, the other fixed ones at 0; RuntimeError when not found."""
        potentials = np.zeros((self.face_count, self.per_face))
        potentials[driven] = 1
        load, solution = self._matrix.createVecLeft(), self._matrix.createVecRight()
        load.array[:] = -self._applied(potentials)[self.free].ravel()
        self._solver.solve(load, solution)
        require_convergence(self._solver)
        potentials[self.free] = solution.array.reshape(-1, self.per_face)
        return FaceSolution(potentials, ALGEBRAIC_SAFETY * self._solver.getResidualNorm() ** 2)

    def energies(self, potentials: Sequence[Array]) -> Array:
        """The quadratic form (n, n) of multipliers (faces, m)."""
        images = [self._applied(own) for own in potentials]
        found = np.array([[np.vdot(a, image) for image in images] for a in potentials])
        return np.asarray((found + found.T) / 2)

    def _applied(self, potentials: Array) -> Array:
        image = np.zeros_like(potentials)
        for forms, faces in self.parts:
            local = potentials[faces].reshape(len(faces), -1, 1)
            flows = (forms @ local).reshape(*faces.shape, self.per_face)
            for k in range(self.per_face):
                image[:, k] += np.bincount(faces.ravel(), flows[:, :, k].ravel(), minlength=self.face_count)
        return image

    def _prepared(self) -> PETSc.KSP:
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
    """The sum of the forms over the free faces, block by block; faces numbered −1 are not free."""
    keys, blocks = [], []
    for forms, faces in parts:
        each = faces.shape[1]
        per_face = forms.shape[1] // each
        split = forms.reshape(-1, each, per_face, each, per_face).transpose(0, 1, 3, 2, 4)
        rows, columns = np.repeat(faces, each, axis=1), np.tile(faces, (1, each))
        kept = (rows >= 0) & (columns >= 0)
        keys.append((rows * count + columns)[kept])
        blocks.append(split.reshape(len(faces), each * each, per_face, per_face)[kept])
    key, block = np.concatenate(keys), np.concatenate(blocks)
    order = np.argsort(key, kind="stable")
    places, starts = np.unique(key[order], return_index=True)
    summed = np.add.reduceat(block[order], starts, axis=0)
    pointers = np.searchsorted(places // count, np.arange(count + 1))
    size = count * block.shape[1]
    return scipy.sparse.bsr_matrix((summed, places % count, pointers), shape=(size, size))


def _without_kernels(matrix: scipy.sparse.bsr_matrix) -> scipy.sparse.bsr_matrix:
    """The matrix with its largest eigenvalue where a face's block has none.

    The form is positive semidefinite, so what a block does not see the whole matrix does not see either: solutions and
    energies stay what they are.
    """
    rows = np.repeat(np.arange(len(matrix.indptr) - 1), np.diff(matrix.indptr))
    diagonal = np.flatnonzero(rows == matrix.indices)
    values, vectors = np.linalg.eigh(matrix.data[diagonal])
    missing = np.where(values < KERNEL * values[:, -1:], values[:, -1:], 0)
    matrix.data[diagonal] += (vectors * missing[:, None, :]) @ vectors.transpose(0, 2, 1)
    return matrix


def _linear_potentials(
    face_vertices: Integers, free: NDArray[np.int64], fixed: Integers, degree: int
) -> scipy.sparse.csr_matrix:
    """Values on the free faces (unknowns, vertices) of the potentials that are 1 at one vertex, and linear in the cells."""
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


def _blocked(matrix: scipy.sparse.bsr_matrix) -> PETSc.Mat:
    pointers, columns = matrix.indptr.astype(PETSc.IntType), matrix.indices.astype(PETSc.IntType)
    return PETSc.Mat().createBAIJ(
        size=matrix.shape,
        bsize=matrix.blocksize[0],
        csr=(pointers, columns, matrix.data),
        comm=PETSc.COMM_SELF,
    )


def _unblocked(matrix: scipy.sparse.csr_matrix) -> PETSc.Mat:
    pointers, columns = matrix.indptr.astype(PETSc.IntType), matrix.indices.astype(PETSc.IntType)
    return PETSc.Mat().createAIJ(
        size=matrix.shape, csr=(pointers, columns, matrix.data), comm=PETSc.COMM_SELF
    )
