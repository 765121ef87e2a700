"""Several processes: their matrix is that of one process to 1e-9, and only one of them prints it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
MPIRUN = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "2"]
SCENE = """
[[sensor]]
name = "front"
plates = [ { corner = [-0.05, -0.05, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] } ]

[[object]]
name = "plate"
shape = { type = "plate", size = [0.06, 0.06] }
translation = [0.01, 0.02, 0.03]

[[object]]
name = "ball"
shape = { type = "sphere", radius = 0.02 }
translation = [0.09, 0.02, 0.03]
potential = "floating"
"""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    return path


def run(processes: list[str], *arguments: str | Path) -> subprocess.CompletedProcess[str]:
    command = [*processes, sys.executable, "-m", "fem_reference", *map(str, arguments)]
    # os.environ lacks the variables that this process's own MPI has set, which the command must not inherit.
    environment = dict(os.environ)
    return subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)


def answer(scene: Path, processes: list[str]) -> dict[str, Any]:
    """The answer by as few levels as there may be, without a limit of time, which would make their number depend on the machine."""
    done = run(processes, scene, "--json", "--error", "estimate", "--rtol", "0.3")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert isinstance(found, dict)
    return found


IN_A_ROOM_FAR_FROM_DUST = """
[room]
size = [3, 3, 3]

[[object]]
name = "dust"
shape = { type = "cube", size = 1e-4 }
translation = [1, 1, 1]
potential = "floating"
"""


@pytest.mark.parametrize(
    "more", ["", IN_A_ROOM_FAR_FROM_DUST], ids=["free space", "a room and a body left out"]
)
def test_two_processes_give_the_matrix_of_one_on_the_same_mesh(scene: Path, more: str) -> None:
    scene.write_text(more + SCENE)
    alone, together = answer(scene, []), answer(scene, MPIRUN)
    assert bool(alone["left_out"]) == bool(more) and alone["left_out"] == together["left_out"]
    assert (alone["processes"], together["processes"]) == (1, 2)
    # One process goes on by both bounds of a mesh, several by halves; the first mesh is the same.
    one, two = alone["levels"][0], together["levels"][0]
    assert one["unknowns"] == two["unknowns"]
    np.testing.assert_allclose(two["maxwell"], one["maxwell"], rtol=1e-9)
    np.testing.assert_allclose(two["delta_self"], one["delta_self"], rtol=1e-8)
    difference = np.abs(np.subtract(together["maxwell"], alone["maxwell"]))
    assert np.all(difference <= np.add(together["error"], alone["error"]))


@pytest.mark.parametrize("arguments", [(), ("--error", "estimate", "--slice", "slice.json")])
def test_what_one_process_does_is_refused_once(scene: Path, arguments: tuple[str, ...]) -> None:
    done = run(MPIRUN, scene, *arguments)
    told = [line for line in done.stderr.splitlines() if line.startswith("fem_reference:")]
    assert done.returncode == 2 and len(told) == 1 and "single process" in told[0]
    assert list(scene.parent.iterdir()) == [scene]
