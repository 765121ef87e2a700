"""The answers of the model's module for one case: the model's by every method, with the time of each; and the matrix by boundary elements with its errors, or why they
have none."""

import importlib
import sys
import time
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any

from analysis.pipeline.stage import NoAnswer
from analysis.results.set_up import is_delta_self
from analysis.results.store import Document
from analysis.results.study_results import COMPARED_METHOD, STATED_RTOLS
from geometries.common.errors import InputError
from geometries.common.installation import module_folders
from geometries.scene import reader
from geometries.scene.person import Person
from geometries.scene.scene import Scene
from geometries.scene.shapes import ROUND_SHAPES, MeshShape
from geometries.studies.families import GROUNDED
from geometries.studies.study import Study

NAME = "model"
# Evaluations per method. One of an integral takes about a microsecond, so the smallest of many times is stored; methods that take
# longer end with the evaluation during which these seconds pass.
_REPEATS, _MOST_SECONDS = 25, 1.0


def model_module() -> Any:
    """Returns the model's Python module, from the build or installed. ModuleNotFoundError when it is not there."""
    for folder in map(str, module_folders()):
        if folder not in sys.path:
            sys.path.insert(0, folder)
    return importlib.import_module("fringe")


def model_is_built() -> bool:
    """Tells whether the model's Python module can be used."""
    try:
        model_module()
    except ModuleNotFoundError:
        return False
    return True


def asking(ask: Callable[[], None]) -> AbstractContextManager[object]:
    """Returns a context in which what the module computes on this thread calls `ask` some times a second, and ends with what that raises."""
    if not model_is_built():
        return nullcontext()
    scope: AbstractContextManager[object] = model_module().InterruptionScope(ask)
    return scope


def knows(scene: Scene) -> bool:
    """Tells whether the model applies: it needs conductors, grounded ones unless its answer says which changes it does not know."""
    if any(body.relative_permittivity is not None for body in scene.objects):
        return False
    return not is_delta_self(scene) or all(body.potential == GROUNDED for body in scene.objects)


def answer(scene: Path, methods: tuple[str, ...]) -> Document:
    """Evaluates a scene file by every method. Of a method that refuses it the reason is stored; "exact" must have an answer."""
    module = model_module()
    answers: Document = {}
    for method in methods:
        try:
            answers[method] = _timed(module, scene, options(method))
        except ValueError as error:
            if method == COMPARED_METHOD:
                raise
            answers[method] = {"refused": str(error).removeprefix(f"{scene}: ")}
    return {"format": 1, "version": str(module.__version__), "methods": answers}


def options(method: str) -> dict[str, Any]:
    """Returns the options of the model for a method of a study (`geometries.studies.study.METHODS`)."""
    accuracy = {"rtol": STATED_RTOLS[method], "entries": True} if method in STATED_RTOLS else {}
    return {"method": method, **accuracy}


def _timed(module: Any, scene: Path, asked: dict[str, Any]) -> Document:
    answers: list[Document] = []
    start = time.monotonic()
    while not answers or (len(answers) < _REPEATS and time.monotonic() - start < _MOST_SECONDS):
        # Each scene is loaded anew, because a scene keeps the results of what has not moved.
        answers.append(module.Scene.load(str(scene)).capacitance(**asked))
    kept = {name: answers[0][name] for name in ("sensors", "readings")}
    return {"seconds": min(answer["seconds"] for answer in answers), **kept}


BOUNDARY_NAME = "boundary elements"
SHARE = 0.1
"""Accuracy asked of boundary elements relative to that asked of the field solver, whose error the comparison shows."""
_STRICTEST, _LOOSEST = 1e-6, 0.5
_STRICTEST_INSULATED = 1e-2
_ROUND = "round bodies: boundary elements answer for the polyhedron of their triangles, the field solver for what is round"


def boundary_rtol(study: Study, scene: Scene, alone: float | None = None) -> float:
    """Returns the relative accuracy asked of boundary elements in a case; `alone` is the case's. If that is None, it is the study's where they
    answer alone, and for a mesh, whose charges converge so slowly that a tenth would take minutes and gigabytes. Beside the field solver it is a
    tenth of it. With dielectric bodies it is at least that at which refinement ends in seconds."""
    if alone is not None:
        return alone
    is_insulated = any(body.relative_permittivity is not None for body in scene.objects)
    has_mesh = any(isinstance(body.shape, MeshShape | Person) for body in scene.objects)
    share = 1.0 if has_mesh or not study.by_field else SHARE
    return min(max(share * study.rtol, _STRICTEST_INSULATED if is_insulated else _STRICTEST), _LOOSEST)


def boundary_answer(scene: Path, study: Study, alone: float | None = None) -> Document:
    """Solves a scene file as accurately as the study asks, or says why boundary elements have no answer."""
    try:
        described = reader.load(scene)
    except InputError as error:
        # This program wrote the scene: somebody has removed or changed it since.
        raise NoAnswer(str(error)) from error
    wanted = boundary_rtol(study, described, alone)
    if any(isinstance(body.shape, ROUND_SHAPES) for body in described.objects):
        return {"rtol": wanted, "refused": _ROUND}
    try:
        return {"rtol": wanted, **model_module().Scene.load(str(scene)).maxwell(rtol=wanted)}
    except ValueError as error:
        # Without the path the reason is the same in every folder.
        return {"rtol": wanted, "refused": str(error).removeprefix(f"{scene}: ")}
