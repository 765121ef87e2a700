"""When gmsh or the solver fails: status 1, the stage and how to see it again, and nothing written."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NoReturn

import gmsh
import pytest

from fem_reference import mesh, solve
from fem_reference.__main__ import main
from fem_reference.stages import stage

SCENE = """
[[sensor]]
name = "front"
plates = [ { corner = [-0.05, -0.05, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] } ]
"""


def fail(*_: Any) -> NoReturn:
    raise Exception("a face without edges")


HURRIED = solve.SOLVER_OPTIONS | {"ksp_max_it": 1}
"""An iteration that does not get anywhere."""


@pytest.mark.parametrize(
    "place, name, instead, words",
    [
        (gmsh.model.occ, "fragment", fail, "building the geometry failed: a face without edges"),
        (gmsh.model.mesh, "generate", fail, "meshing failed: a face without edges"),
        (mesh, "set_size_field", fail, "meshing failed: a face without edges"),
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
    scene.write_text(SCENE)
    monkeypatch.setattr(place, name, instead)
    assert main([str(scene), "--json", "--output", str(tmp_path / "field.vtu")]) == 1
    said = capsys.readouterr()
    assert said.out == "" and str(scene) in said.err and words in said.err
    assert f"python3 -m fem_reference '{scene}' --json" in said.err
    assert list(tmp_path.iterdir()) == [scene]


def test_running_out_of_memory_is_not_disguised() -> None:
    with pytest.raises(MemoryError), stage("meshing"):
        raise MemoryError
