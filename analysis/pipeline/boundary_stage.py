"""Boundary elements on one case of a study: their matrix with its errors, or why they have none."""

from __future__ import annotations

from pathlib import Path

from analysis.pipeline import model_stage
from analysis.pipeline.stage import NoAnswer
from analysis.results.store import Document
from analysis.results.study_results import Results
from analysis.results.table import model_command
from geometries.common.errors import InputError
from geometries.scene import reader
from geometries.scene.scene import Scene
from geometries.scene.shapes import ROUND_SHAPES, MeshShape

NAME = "boundary elements"
SHARE = 0.1
"""Accuracy asked of boundary elements relative to that asked of the field solver, whose error the comparison shows."""
_STRICTEST, _LOOSEST = 1e-6, 0.5
_ROUND = "round bodies: boundary elements answer for the polyhedron of their triangles, the field solver for what is round"


def rtol(asked: float, scene: Scene) -> float:
    """Returns the relative accuracy asked of boundary elements where `asked` is asked of the field solver.

    For a mesh it is the same as `asked`: its charges converge so slowly that a tenth would take minutes and gigabytes.
    """
    has_mesh = any(isinstance(body.shape, MeshShape) for body in scene.objects)
    return min(max(asked if has_mesh else SHARE * asked, _STRICTEST), _LOOSEST)


def boundary_command(results: Results, case: str) -> str:
    """Returns the command, from the repository's folder, that computes the boundary elements' answer for a case."""
    asked = rtol(results.rtol, results.cases[case].scene)
    return f"{model_command(results, case, 'boundary-elements')} --rtol {asked:g}"


def answer(scene: Path, asked: float) -> Document:
    """Solves a scene file, or says why there is nothing to compare; `asked` is the field solver's relative accuracy."""
    try:
        described = reader.load(scene)
    except InputError as error:
        # This program wrote the scene: somebody has removed or changed it since.
        raise NoAnswer(str(error)) from error
    return {"rtol": rtol(asked, described), **_answer_or_refusal(scene, described, rtol(asked, described))}


def _answer_or_refusal(scene: Path, described: Scene, wanted: float) -> Document:
    if any(isinstance(body.shape, ROUND_SHAPES) for body in described.objects):
        return {"refused": _ROUND}
    try:
        solved: Document = model_stage.model_module().Scene.load(str(scene)).maxwell(rtol=wanted)
    except ValueError as error:
        return {"refused": _without_place(str(error), scene)}
    return solved


def _without_place(reason: str, scene: Path) -> str:
    """Removes the path from a reason, so that it is the same in every folder."""
    return reason.removeprefix(f"{scene}: ")
