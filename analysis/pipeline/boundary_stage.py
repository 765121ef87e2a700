"""Boundary elements on one case of a study: their matrix with its errors, or why they have none."""

from __future__ import annotations

from pathlib import Path

from analysis.pipeline import model_stage
from analysis.pipeline.stage import NoAnswer
from analysis.results.store import Document
from geometries.common.errors import InputError
from geometries.scene import reader
from geometries.scene.scene import Scene
from geometries.scene.person import Person
from geometries.scene.shapes import ROUND_SHAPES, MeshShape
from geometries.studies.study import Study

NAME = "boundary elements"
SHARE = 0.1
"""Accuracy asked of boundary elements relative to that asked of the field solver, whose error the comparison shows."""
_STRICTEST, _LOOSEST = 1e-6, 0.5
_STRICTEST_INSULATED = 1e-2
_ROUND = "round bodies: boundary elements answer for the polyhedron of their triangles, the field solver for what is round"


def rtol(study: Study, scene: Scene, alone: float | None = None) -> float:
    """Returns the relative accuracy asked of boundary elements in a case; `alone` is the case's.

    If that is None, it is the study's where they answer alone, and for a mesh, whose charges converge so slowly that a tenth would take minutes and
    gigabytes. Beside the field solver it is a tenth of it. With dielectric bodies it is at least that at which refinement ends in seconds.
    """
    if alone is not None:
        return alone
    is_insulated = any(body.relative_permittivity is not None for body in scene.objects)
    has_mesh = any(isinstance(body.shape, MeshShape | Person) for body in scene.objects)
    share = 1.0 if has_mesh or not study.by_field else SHARE
    return min(max(share * study.rtol, _STRICTEST_INSULATED if is_insulated else _STRICTEST), _LOOSEST)


def answer(scene: Path, study: Study, alone: float | None = None) -> Document:
    """Solves a scene file as accurately as the study asks, or says why boundary elements have no answer."""
    try:
        described = reader.load(scene)
    except InputError as error:
        # This program wrote the scene: somebody has removed or changed it since.
        raise NoAnswer(str(error)) from error
    wanted = rtol(study, described, alone)
    return {"rtol": wanted, **_answer_or_refusal(scene, described, wanted)}


def _answer_or_refusal(scene: Path, described: Scene, wanted: float) -> Document:
    if any(isinstance(body.shape, ROUND_SHAPES) for body in described.objects):
        return {"refused": _ROUND}
    try:
        solved: Document = model_stage.model_module().Scene.load(str(scene)).maxwell(rtol=wanted)
    except ValueError as error:
        # Without the path the reason is the same in every folder.
        return {"refused": str(error).removeprefix(f"{scene}: ")}
    return solved
