"""The size of the tetrahedra as a function of a point, evaluated by compiled code, which gmsh calls for every point it asks about.

gmsh's own expressions (MathEval) give the same sizes, but take most of the time of meshing.
"""

from __future__ import annotations

import ctypes
from functools import cache

import gmsh
import numpy as np
from numpy.typing import NDArray

from fem_reference.mesh.tape import Expression
from geometries.common import installation
from geometries.common.arrays import Array


class SizeFunction:
    """The value of an expression of a tape at every point."""

    def __init__(self, size: Expression) -> None:
        tape = size.tape
        steps = np.array(tape.steps, dtype=np.intc)
        constants = np.array(tape.constants, dtype=float)
        counts = np.array([len(triangles) for triangles in tape.surfaces], dtype=np.uintp)
        corners = np.concatenate([np.zeros(0), *(triangles.ravel() for triangles in tape.surfaces)])
        offsets = np.concatenate([np.zeros(0), *tape.offsets])
        self._library = _library()
        self._handle = ctypes.c_void_p(
            self._library.fringe_sizes_new(
                ctypes.c_size_t(len(steps)),
                _pointer(steps),
                _pointer(constants),
                ctypes.c_size_t(len(counts)),
                _pointer(counts),
                _pointer(corners),
                _pointer(offsets),
                ctypes.c_size_t(size.register),
            )
        )

    def __del__(self) -> None:
        self._library.fringe_sizes_delete(self._handle)

    def __call__(self, points: Array) -> Array:
        """The values (n,) at points (n, 3)."""
        given = np.ascontiguousarray(points, dtype=float)
        values = np.empty(len(given))
        count = ctypes.c_size_t(len(given))
        self._library.fringe_sizes_evaluate(self._handle, count, _pointer(given), _pointer(values))
        return values

    def set_in_gmsh(self) -> None:
        """Make it the size of the cells of the current gmsh model. gmsh keeps no reference: the function must outlive the meshing."""
        status = ctypes.c_int()
        gmsh.lib.gmshModelMeshSetSizeCallback(
            self._library.fringe_sizes_at, self._handle, ctypes.byref(status)
        )
        if status.value:
            raise RuntimeError(gmsh.logger.getLastError())


@cache
def _library() -> ctypes.CDLL:
    """Load the compiled code; raises OSError, with what to do, if it was not built."""
    path = installation.sizes_library()
    if not path.is_file():
        raise OSError(f"{installation.from_repository(path)} is missing: ./run builds it")
    library = ctypes.CDLL(str(path))
    library.fringe_sizes_new.restype = ctypes.c_void_p
    library.fringe_sizes_delete.restype = None
    library.fringe_sizes_evaluate.restype = None
    return library


def _pointer(array: NDArray[np.generic]) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)
