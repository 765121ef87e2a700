"""Failures of gmsh or the solver: exit status 1, a message with the stage and the command that reproduces it, and no file written."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn

import gmsh
import numpy as np
import pytest

from fem_reference.mesh import tagged_mesh as mesh
from fem_reference.solve import field_problem as solve
from fem_reference.__main__ import main
from fem_reference.bodies.shapes import Rectangle
from fem_reference.mesh.tagged_mesh import tagged_mesh
from fem_reference.mesh.size_rules import Sizing
from fem_reference.common.stages import stage
from tests.scenes import SENSOR


def fail(*_: Any) -> NoReturn:
    raise Exception("a face without edges")


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
    place: Any,
    name: str,
    instead: Any,
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    scene = tmp_path / "a scene.toml"
    scene.write_text(SENSOR)
    monkeypatch.setattr(place, name, instead)
    assert main([str(scene), "--json", "--output", str(tmp_path / "field.vtu")]) == 1
    said = capsys.readouterr()
    assert said.out == "" and str(scene) in said.err and words in said.err
    assert f"python3 -m fem_reference '{scene}' --json" in said.err
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
    plate = Rectangle("plate", np.zeros(3), np.eye(3), (0.5, 0.5))
    assert tagged_mesh([plate], [0], Sizing()).cell_count > 1000
    assert len(algorithms) == 2 and algorithms[1] == mesh.MESH_ADAPT != algorithms[0]


def test_a_mesh_that_cannot_be_made_either_way_is_a_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        gmsh.model.mesh, "generate", lambda _: gmsh.logger.write("PLC Error: at a point", "error")
    )
    with pytest.raises(RuntimeError, match="meshing failed: .*PLC Error: at a point"):
        tagged_mesh([Rectangle("plate", np.zeros(3), np.eye(3), (0.5, 0.5))], [0], Sizing())
