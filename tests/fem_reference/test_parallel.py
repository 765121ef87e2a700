"""Several processes: on the same mesh their matrix and its bounds are those of one process, and only one of them prints them."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fem_reference.__main__ import main
from tests import scenes
from tests.by_night import all_but
from tests.programs import in_this_process

ROOT = Path(__file__).resolve().parents[2]
MPIRUN = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n"]
SCENE = (
    "[room]\nsize = [3, 3, 3]\n"
    + scenes.body("dust", "cube", size=1e-4, translation=[1, 1, 1], potential="floating")
    + scenes.body("plate", "plate", size=[0.06, 0.06], translation=[0, 0, 0.03])
    + scenes.body("ball", "sphere", radius=0.02, translation=[0, 0, 0.08], potential="floating")
    + scenes.SENSOR
)


def run(count: int, *arguments: str | Path) -> subprocess.CompletedProcess[str]:
    command = [*MPIRUN, str(count), sys.executable, "-m", "fem_reference", *map(str, arguments)]
    # os.environ lacks the variables that this process's own MPI has set, which the command must not inherit.
    environment = dict(os.environ)
    return subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)


def answers(scene: Path, rtol: str, count: int) -> tuple[dict[str, Any], dict[str, Any]]:
    """The answers of one process and of several, without a limit of time, which would make the number of levels depend on the machine."""
    done = run(count, scene, "--json", "--rtol", rtol)
    assert done.returncode == 0, done.stderr
    several = json.loads(done.stdout)
    # In this process, which has loaded the solver for other tests.
    alone = in_this_process(main, scene, "--json", "--rtol", rtol)
    assert alone.returncode == 0, alone.stderr
    one = json.loads(alone.stdout)
    assert (one["processes"], several["processes"]) == (1, count)
    first, other = one["levels"][0], several["levels"][0]
    assert first["unknowns"] == other["unknowns"]
    np.testing.assert_allclose(other["maxwell"], first["maxwell"], rtol=1e-9)
    np.testing.assert_allclose(other["delta_self"], first["delta_self"], rtol=1e-8)
    return one, several


@pytest.mark.parametrize("processes", all_but([2], [2, 4]))
def test_several_processes_enclose_as_one_does_on_the_same_mesh(scene: Path, processes: int) -> None:
    """In a room, with a curved body that floats, and one that is left out. Of four processes, some hold a cell on the body's surface
    as a ghost without the cell inside the body."""
    alone, together = answers(scene, "0.3", processes)
    assert len(alone["levels"]) == len(together["levels"]) == 1
    assert alone["left_out"] and alone["left_out"] == together["left_out"]
    own = np.diag(alone["maxwell"])
    # Lower bounds are lowered by what the iteration for the fluxes may have left.
    for kind in ("lower", "upper", "maxwell", "error"):
        assert np.abs(np.subtract(together[kind], alone[kind])).max() < 1e-5 * own.max()


@pytest.mark.night
def test_two_processes_adapt_the_mesh_and_enclose_what_one_does(scene: Path) -> None:
    """The mesh is divided between them in another way in every run, and with it the adapted one and the number of its levels differ."""
    scene.write_text(scenes.SENSOR)
    alone, together = answers(scene, "5e-4", 2)
    assert together["reached"] and len(together["levels"]) >= 2
    ((lower,),), ((upper,),) = together["lower"], together["upper"]
    assert upper - lower <= 2 * 5e-4 * together["maxwell"][0][0]
    assert max(lower, alone["lower"][0][0]) < min(upper, alone["upper"][0][0])


FILES = [("--output", "field.vtu"), ("--slice", "slice.json")]


@pytest.mark.parametrize("arguments", all_but(FILES[:1], FILES))
def test_what_one_process_does_is_refused_once(scene: Path, arguments: tuple[str, ...]) -> None:
    done = run(2, scene, *arguments)
    told = [line for line in done.stderr.splitlines() if line.startswith("fem_reference:")]
    # mpirun ends the other process as soon as one has failed, often before that has ended by itself.
    told = [line for line in told if "ended by SIGTERM" not in line]
    assert done.returncode == 2 and len(told) == 1 and "single process" in told[0]
    assert list(scene.parent.iterdir()) == [scene]
