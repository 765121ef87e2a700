"""Several processes: on the same mesh their matrix and its bounds are those of one process, and only one of them prints them."""

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
translation = [0, 0, 0.03]

[[object]]
name = "ball"
shape = { type = "sphere", radius = 0.02 }
translation = [0, 0, 0.08]
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


def answer(scene: Path, processes: list[str], error: str, rtol: str) -> dict[str, Any]:
    """The answer without a limit of time, which would make the number of levels depend on the machine."""
    done = run(processes, scene, "--json", "--error", error, "--rtol", rtol)
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
    "more, error",
    [("", "enclosure"), (IN_A_ROOM_FAR_FROM_DUST, "estimate")],
    ids=["enclosed in free space", "estimated in a room, with a body left out"],
)
def test_two_processes_give_the_answer_of_one_on_the_same_mesh(scene: Path, more: str, error: str) -> None:
    scene.write_text(more + SCENE)
    alone, together = answer(scene, [], error, "0.3"), answer(scene, MPIRUN, error, "0.3")
    assert bool(alone["left_out"]) == bool(more) and alone["left_out"] == together["left_out"]
    assert (alone["processes"], together["processes"]) == (1, 2)
    (one,), (two,) = alone["levels"], together["levels"]
    assert one["unknowns"] == two["unknowns"]
    np.testing.assert_allclose(two["maxwell"], one["maxwell"], rtol=1e-9)
    np.testing.assert_allclose(two["delta_self"], one["delta_self"], rtol=1e-8)
    # Lower bounds are lowered by what the iteration for the fluxes may have left.
    own = np.diag(alone["maxwell"])
    for kind in ("lower", "upper", "maxwell", "error"):
        assert np.abs(np.subtract(together[kind], alone[kind])).max() < 1e-5 * own.max()


PLATE = """
[[sensor]]
name = "front"
plates = [ { corner = [-0.05, -0.05, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] } ]
"""


def test_two_processes_adapt_the_mesh_and_enclose_what_one_does(scene: Path) -> None:
    scene.write_text(PLATE)
    alone, together = (answer(scene, processes, "enclosure", "5e-4") for processes in ([], MPIRUN))
    assert len(together["levels"]) == len(alone["levels"]) == 2
    ((lower,),), ((upper,),) = together["lower"], together["upper"]
    assert upper - lower <= 2 * 5e-4 * together["maxwell"][0][0]
    assert max(lower, alone["lower"][0][0]) < min(upper, alone["upper"][0][0])


@pytest.mark.parametrize("arguments", [("--output", "field.vtu"), ("--slice", "slice.json")])
def test_what_one_process_does_is_refused_once(scene: Path, arguments: tuple[str, ...]) -> None:
    done = run(MPIRUN, scene, *arguments)
    told = [line for line in done.stderr.splitlines() if line.startswith("fem_reference:")]
    assert done.returncode == 2 and len(told) == 1 and "single process" in told[0]
    assert list(scene.parent.iterdir()) == [scene]
