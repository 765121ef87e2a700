"""What an answer may take: seconds, unknowns, memory; and what the next level would."""

from __future__ import annotations

import math
import resource
from dataclasses import dataclass

from mpi4py import MPI

BYTES_PER_UNIT_OF_MAXRSS = 1024
"""Linux counts the peak of a process in kibibytes."""


@dataclass(frozen=True)
class Limits:
    """No level is begun that would go beyond one of these."""

    seconds: float = math.inf
    unknowns: float = math.inf
    memory: float = math.inf
    """Bytes."""

    def exceeded_by(self, seconds: float, unknowns: float, memory: float) -> str | None:
        """The first limit that these exceed, in words; None when all are kept."""
        if seconds > self.seconds:
            return f"the next level would end after {self.seconds:g} s"
        if unknowns > self.unknowns:
            return f"the next level would have more than {self.unknowns:.0f} unknowns"
        if memory > self.memory:
            return f"the next level would take more than {self.memory / 2**30:.3g} GiB"
        return None


def peak_memory() -> int:
    """The most memory (bytes) that the processes have held so far, all together."""
    own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * BYTES_PER_UNIT_OF_MAXRSS
    return int(MPI.COMM_WORLD.allreduce(own))
