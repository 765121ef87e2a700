"""Values at the entities of a mesh that several processes share.

Every process holds cells of its own and, as ghosts, the cells beyond their faces. Entities of its own come first in its numbering, and have
the same order in the numbering of the whole mesh.
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from dolfinx import la
from dolfinx.cpp.common import IndexMap
from mpi4py import MPI
from numpy.typing import NDArray

from geometries.common.arrays import Array, Flags, Indices

Number = TypeVar("Number", bound=np.generic)


def whole_numbers(entities: IndexMap) -> Indices:
    """The numbers (n,) in the whole mesh of the entities that this process holds."""
    count = entities.size_local + entities.num_ghosts
    return np.asarray(entities.local_to_global(np.arange(count, dtype=np.int32)), dtype=np.int64)


def from_owners(entities: IndexMap, values: Array) -> Array:
    """The values (n, …) at the entities that this process holds: those of ghosts are replaced by their owners'."""
    return _scattered(entities, values, False)


def summed(entities: IndexMap, values: Array) -> Array:
    """The sums (n, …) over all processes of their values at the entities that this process holds."""
    return _scattered(entities, values, True)


def _scattered(entities: IndexMap, values: Array, add: bool) -> Array:
    vector = la.vector(entities, int(np.prod(values.shape[1:])))
    vector.array[:] = values.ravel()
    if add:
        vector.scatter_reverse(la.ScatterMode.add)
    vector.scatter_forward()
    return np.array(vector.array).reshape(values.shape)


def numbered(entities: IndexMap, comm: MPI.Intracomm, chosen: Flags) -> tuple[Indices, int]:
    """Number the `chosen` (n,) ones of the entities that this process holds without gaps over all processes.

    Returns the numbers (n,), of which only those of chosen entities count, and how many chosen ones the process owns.
    """
    own = int(chosen[: entities.size_local].sum())
    first = comm.scan(own) - own
    # Numbers of entities are exact in floating point.
    numbers = (first + np.cumsum(chosen) - 1).astype(np.float64)
    return from_owners(entities, numbers).astype(np.int64), own


def gathered(comm: MPI.Intracomm, own: NDArray[Number]) -> NDArray[Number]:
    """What all processes have, in the order of the whole mesh, on every process."""
    return own if comm.size == 1 else np.concatenate(comm.allgather(own))
