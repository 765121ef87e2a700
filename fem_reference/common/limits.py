"""Limits on the time, the unknowns and the memory of an answer, and the names of its stages for messages."""

from __future__ import annotations

import math
import resource
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from mpi4py import MPI

BYTES_PER_UNIT_OF_MAXRSS = 1024
"""Bytes per unit of `ru_maxrss`, the peak memory of a process, which Linux counts in kibibytes."""


@dataclass(frozen=True)
class Limits:
    """Limits of the whole solution: no level is started that is predicted to exceed one of them."""

    seconds: float = math.inf
    unknowns: float = math.inf
    memory: float = math.inf
    """Limit of the memory of all processes together, in bytes."""

    def exceeded_by(self, seconds: float, unknowns: float, memory: float) -> str | None:
        """The first limit that these predictions exceed, in words; None when they keep all limits."""
        if seconds > self.seconds:
            return f"the next level would end after {self.seconds:g} s"
        if unknowns > self.unknowns:
            return f"the next level would have more than {self.unknowns:.0f} unknowns"
        if memory > self.memory:
            return f"the next level would take more than {self.memory / 2**30:.3g} GiB"
        return None


def peak_memory() -> int:
    """Sum of the peak memories (bytes) of all processes so far."""
    own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * BYTES_PER_UNIT_OF_MAXRSS
    return int(MPI.COMM_WORLD.allreduce(own))


@contextmanager
def stage(name: str) -> Iterator[None]:
    """Convert exceptions of the libraries into a RuntimeError that names the stage.

    gmsh raises plain Exceptions, and PETSc RuntimeErrors that contain only a number. A MemoryError is not converted.
    """
    try:
        yield
    except MemoryError:
        raise
    except Exception as failure:
        raise RuntimeError(f"{name} failed: {failure}") from failure
