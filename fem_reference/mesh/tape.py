"""Records formulas in the coordinates of a point as a list of operations, which compiled code evaluates (`SizeFunction`).

A formula is written once, for numpy: `np.sqrt(x**2 + y**2)` is an array where x and y are arrays, and an `Expression` where they are
expressions of a tape. gmsh calls the compiled code for every point whose size it asks about. Its own expressions (MathEval) give the same
sizes, but take most of the time of meshing.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import gmsh
import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import NDArray

from geometries.common import installation
from geometries.common.arrays import Array

Quantity = Any
"""An array, or an expression of a tape: whatever numpy's functions accept and return."""
Point = Sequence[Quantity] | Array
"""The three coordinates of one or many points."""

COORDINATES = 3
"""Number of the registers that hold the point: those numbered 0, 1 and 2."""
CONSTANT, DISTANCE = 0, 1
"""Numbers of the operations that read a constant, and that find the distance to a surface or to curves of the tape."""
OPERATIONS: dict[Callable[..., Any], int] = {
    np.add: 2,
    np.subtract: 3,
    np.multiply: 4,
    np.divide: 5,
    np.minimum: 6,
    np.maximum: 7,
    np.sqrt: 8,
    np.absolute: 9,
}
"""Numbers of the other operations; those of one operand ignore the second. `sizes/size_function.cpp` has the same numbers."""


@dataclass
class Tape:
    """Steps, each of which fills the register after those of the steps before it; equal steps are recorded once."""

    steps: list[tuple[int, int, int]] = field(default_factory=list)
    """Each step's operation and its operands: registers, or the number of the constant or of the surface."""
    constants: list[float] = field(default_factory=list)
    surfaces: list[Array] = field(default_factory=list)
    """Triangles (n, 3, 3), to which the tape has distances; those with two equal corners are segments."""
    offsets: list[Array] = field(default_factory=list)
    """(n,): what is added to the distance from each of the triangles of a surface."""
    known: dict[tuple[Any, ...], int] = field(default_factory=dict)
    """The registers of steps, and of constants."""

    @property
    def point(self) -> tuple[Expression, Expression, Expression]:
        """The coordinates x, y and z."""
        return Expression(self, 0), Expression(self, 1), Expression(self, 2)

    def constant(self, value: float) -> Expression:
        """The expression of a constant."""
        if ("constant", value) not in self.known:
            self.constants.append(value)
            self.known["constant", value] = self._record(CONSTANT, len(self.constants) - 1, 0)
        return Expression(self, self.known["constant", value])

    def distance(self, triangles: Array, offsets: Array | None = None) -> Expression:
        """The distance of the point from the nearest of triangles (n, 3, 3), or the least sum of a distance and an offset (n,)."""
        self.surfaces.append(triangles)
        self.offsets.append(np.zeros(len(triangles)) if offsets is None else offsets)
        return Expression(self, self._record(DISTANCE, len(self.surfaces) - 1, 0))

    def apply(self, operation: int, operands: Sequence[Quantity]) -> Expression:
        """The expression of an operation on one or two operands, expressions or numbers."""
        registers = [
            value.register if isinstance(value, Expression) else self.constant(float(value)).register
            for value in operands
        ]
        step = (operation, registers[0], registers[-1])
        if step not in self.known:
            self.known[step] = self._record(*step)
        return Expression(self, self.known[step])

    def _record(self, operation: int, first: int, second: int) -> int:
        self.steps.append((operation, first, second))
        return COORDINATES + len(self.steps) - 1


class Expression(NDArrayOperatorsMixin):
    """A number that depends on the point: a register of a tape."""

    def __init__(self, tape: Tape, register: int) -> None:
        self.tape = tape
        self.register = register

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Quantity, **kwargs: Any) -> Any:
        if method != "__call__" or kwargs:
            return NotImplemented
        if ufunc is np.square or (ufunc is np.power and inputs[1] == 2):
            return self.tape.apply(OPERATIONS[np.multiply], (inputs[0], inputs[0]))
        if ufunc is np.negative:
            return self.tape.apply(OPERATIONS[np.subtract], (0.0, inputs[0]))
        if ufunc not in OPERATIONS:
            return NotImplemented
        return self.tape.apply(OPERATIONS[ufunc], inputs)


def smallest(quantities: Sequence[Quantity]) -> Quantity:
    """The smallest of several quantities, at each point."""
    found = quantities[0]
    for quantity in quantities[1:]:
        found = np.minimum(found, quantity)
    return found


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
