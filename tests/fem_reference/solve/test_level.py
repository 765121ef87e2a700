"""Repeated solution of one level in one process: its memory is freed."""

from pathlib import Path
from resource import getpagesize

import numpy as np
import pytest

from fem_reference.bodies.shapes import Rectangle
from fem_reference.solve.level import Bounds, solve_level
from fem_reference.bodies.conductors import normalised
from fem_reference.mesh.sizing import Sizing
from fem_reference.bodies.symmetry import mirror_planes


def memory_in_use() -> int:
    """The memory (bytes) that the process holds now."""
    return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * getpagesize()


@pytest.mark.parametrize("bounds", ["none", "estimate", "enclosure"])
def test_a_level_leaves_no_memory_behind(bounds: Bounds) -> None:
    """The matrices of the level take some 10 MB, its bounds three times as much."""
    plates = [
        Rectangle(name, np.array([0, 0, z]), np.eye(3), (0.5, 0.5)) for name, z in (("a", 0), ("b", 0.4))
    ]
    problem = normalised(["a", "b"], 1, plates, range(2))
    planes = mirror_planes(problem.bodies, problem.owner, problem.room)
    used = []
    for _ in range(4):
        solve_level(problem, 1.0, Sizing(), bounds, planes)
        used.append(memory_in_use())
    assert used[3] - used[1] < 5 * 2**20
