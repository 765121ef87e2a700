"""Failures of gmsh or the solver: exit status 1, a message with the stage and the command that reproduces it, and no file written.
Nothing is left, neither a process nor a file, of a field solver that is ended while a program wraps a mesh."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn

import gmsh
import numpy as np
import pytest

from fem_reference.__main__ import main
from fem_reference.common.limits import stage
from fem_reference.mesh import tagged_mesh as mesh
from fem_reference.mesh.sizing import Sizing
from fem_reference.mesh.tagged_mesh import tagged_mesh
from fem_reference.solve import field_problem as solve
from tests import scenes
from tests.fem_reference.problems import PLATE, conductors_of
from tests.programs import in_this_process
from tests.scenes import SENSOR
from tests.waiting import heed_signals, marked, wait_until


def fail(*_: Any) -> NoReturn:
    raise Exception("a face without edges")


ONE_PLATE = conductors_of([PLATE])
HURRIED = solve.SOLVER_OPTIONS | {"ksp_max_it": 1}
"""Solver options with which the iteration does not converge."""


@pytest.mark.parametrize(
    "place, name, instead, words",
    [
        (gmsh.model.occ, "fragment", fail, "building the geometry failed: a face without edges"),
        (gmsh.model.mesh, "generate", fail, "meshing failed: a face without edges"),
        (mesh, "size_function", fail, "meshing failed: a face without edges"),
        (solve, "_stiffness", fail, "assembling the equations failed: a face without edges"),
        (solve, "SOLVER_OPTIONS", HURRIED, "solving the equations failed: the linear solver stopped"),
    ],
    ids=["geometry", "mesh", "sizes", "assembly", "solver"],
)
def test_a_failure_names_its_stage_and_leaves_nothing(
    place: Any, name: str, instead: Any, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = tmp_path / "a scene.toml"
    scene.write_text(SENSOR)
    monkeypatch.setattr(place, name, instead)
    done = in_this_process(main, scene, "--json", "--output", tmp_path / "field.vtu")
    assert (done.returncode, done.stdout) == (1, "") and str(scene) in done.stderr and words in done.stderr
    assert f"python3 -m fem_reference '{scene}' --json" in done.stderr
    assert list(tmp_path.iterdir()) == [scene]


def test_running_out_of_memory_is_not_disguised() -> None:
    with pytest.raises(MemoryError), stage("meshing"):
        raise MemoryError


def report_crossing() -> None:
    gmsh.logger.write("PLC Error: a segment and a facet intersect", "error")


def flatten_a_tetrahedron() -> None:
    """Move the first corner of a tetrahedron into the plane of the other three."""
    corners = gmsh.model.mesh.getElementsByType(mesh.TETRAHEDRON)[1][:4]
    others = [gmsh.model.mesh.getNode(corner)[0] for corner in corners[1:]]
    gmsh.model.mesh.setNode(corners[0], np.mean(others, axis=0), [])


@pytest.mark.parametrize("fault", [report_crossing, flatten_a_tetrahedron])
def test_a_mesh_whose_surfaces_cross_or_with_flat_cells_is_made_another_way(
    fault: Callable[[], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    algorithms: list[float] = []
    generate = gmsh.model.mesh.generate

    def fail_once(dimension: int) -> None:
        algorithms.append(gmsh.option.getNumber("Mesh.Algorithm"))
        generate(dimension)
        if len(algorithms) == 1:
            fault()

    monkeypatch.setattr(gmsh.model.mesh, "generate", fail_once)
    assert tagged_mesh(ONE_PLATE, Sizing()).cell_count > 1000
    assert len(algorithms) == 2 and algorithms[1] == mesh.MESH_ADAPT != algorithms[0]


def test_a_mesh_that_cannot_be_made_either_way_is_a_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        gmsh.model.mesh, "generate", lambda _: gmsh.logger.write("PLC Error: at a point", "error")
    )
    with pytest.raises(RuntimeError, match="meshing failed: .*PLC Error: at a point"):
        tagged_mesh(ONE_PLATE, Sizing())


ROOT = Path(__file__).resolve().parents[2]
WRAP = str(ROOT / "build" / "bin" / "fringe-wrap")
# Smallest hollow (m) that the wrap is to follow: it takes far longer than the test.
ALPHA = "2e-4"


@pytest.fixture
def command(tmp_path: Path) -> list[str]:
    """The field solver for a square tube, open at both ends."""
    corners = 0.04 * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    lines = [f"v {x} {y} {z}" for z in (-0.5, 0.5) for x, y in corners]
    lines += [f"f {k + 1} {(k + 1) % 4 + 1} {(k + 1) % 4 + 5} {k + 5}" for k in range(4)]
    (tmp_path / "tube.obj").write_text("\n".join(lines) + "\n")
    (tmp_path / "scene.toml").write_text(scenes.body("tube", "mesh", file="tube.obj", potential="electrode"))
    (tmp_path / "temporary").mkdir()
    return [sys.executable, "-m", "fem_reference", str(tmp_path / "scene.toml"), "--wrap-alpha", ALPHA]


def environment(folder: Path) -> dict[str, str]:
    return os.environ | {"TMPDIR": str(folder)}


def nothing_is_left(folder: Path) -> bool:
    return not marked(folder) and not list(folder.iterdir())


@pytest.mark.parametrize("ending", [signal.SIGKILL, signal.SIGHUP])
def test_the_wrap_ends_with_the_field_solver(
    tmp_path: Path, command: list[str], ending: signal.Signals
) -> None:
    folder = tmp_path / "temporary"
    with subprocess.Popen(
        command,
        cwd=ROOT,
        env=environment(folder),
        stderr=subprocess.PIPE,
        start_new_session=True,
        preexec_fn=heed_signals,
    ) as solver:
        try:
            wait_until(lambda: any(words.startswith(WRAP) for words in marked(folder).values()), "a wrap")
        finally:
            solver.send_signal(ending)
    wait_until(lambda: nothing_is_left(folder), "the end of all processes and files")


def test_the_limit_of_time_ends_a_wrap(tmp_path: Path, command: list[str]) -> None:
    """People get the message alone."""
    folder = tmp_path / "temporary"
    words = [*command, "--max-seconds", "0.1"]
    done = subprocess.run(
        words, cwd=ROOT, env=environment(folder), capture_output=True, text=True, check=False
    )
    assert done.returncode == 3 and done.stdout == ""
    assert "no level was finished within 0.1 s; " in done.stderr
    assert "wrapped" in done.stderr and "--wrap-alpha" in done.stderr
    wait_until(lambda: nothing_is_left(folder), "the end of all processes and files")
