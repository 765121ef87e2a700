"""Boundary elements on one case of a study: their matrix with its errors, or why they have none."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from analysis.results.store import Document, write_json
from analysis.results.study_results import Failure, Results
from analysis.results.table import model_command
from geometries.common.errors import InputError
from geometries.scene import reader
from geometries.scene.scene import Scene
from geometries.scene.shapes import Arc, Cone, Cylinder, MeshShape, Sphere

STAGE = "boundary elements"
SHARE = 0.1
"""Of the accuracy asked of the field solver: its own error is what the comparison is to show."""
_STRICTEST, _LOOSEST = 1e-6, 0.5
_ROUND = "round bodies: boundary elements answer for the polyhedron of their triangles, the field solver for what is round"


def rtol(asked: float, scene: Scene) -> float:
    """What is asked of boundary elements where `asked` is asked of the field solver.

    Of a mesh no more than that: its charges converge so slowly that a tenth would take minutes and gigabytes.
    """
    has_mesh = any(isinstance(body.shape, MeshShape) for body in scene.objects)
    return min(max(asked if has_mesh else SHARE * asked, _STRICTEST), _LOOSEST)


def boundary_command(results: Results, case: str) -> str:
    """The command, from the repository's folder, that computes the boundary elements' answer for a case."""
    asked = rtol(results.rtol, results.cases[case].scene)
    return f"{model_command(results, case, 'boundary-elements')} --rtol {asked:g}"


def evaluate(scene: Path, target: Path, key: str, asked: float, module: Any) -> Failure | None:
    """Solve a scene file and store the answer, or the reason for which there is none to compare, with the key; `asked` is the
    field solver's relative accuracy. Returns why, when there is neither."""
    try:
        described = reader.load(scene)
    except InputError as error:
        # It was written by this program: somebody has removed or changed it meanwhile.
        return Failure(scene.parent.name, STAGE, str(error))
    wanted = rtol(asked, described)
    try:
        if any(isinstance(body.shape, Arc | Cone | Cylinder | Sphere) for body in described.objects):
            answer: Document = {"refused": _ROUND}
        else:
            answer = _answer(module.Scene.load(str(scene)).maxwell(rtol=wanted))
    except ValueError as error:
        answer = {"refused": _without_place(str(error), scene)}
    except RuntimeError as error:
        return Failure(scene.parent.name, STAGE, str(error))
    write_json(target, {"key": key, "rtol": wanted, **answer})
    return None


def _answer(solved: Document) -> Document:
    return {
        "conductors": list(solved["conductors"]),
        "maxwell": solved["maxwell"].tolist(),
        "error": solved["error"].tolist(),
        "lower_bounds": [bool(bound) for bound in solved["lower_bounds"]],
        "delta_self": solved["delta_self"],
        "reached": bool(solved["reached"]),
        "unknowns": int(solved["unknowns"]),
        "seconds": float(solved["seconds"]),
    }


def _without_place(reason: str, scene: Path) -> str:
    """The reason alone: the same in every folder."""
    return reason.removeprefix(f"{scene}: ")
