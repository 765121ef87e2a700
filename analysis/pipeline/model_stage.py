"""The model's answers for one case, by every method, with the time of each."""

from __future__ import annotations

import importlib
import sys
import time
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any

from analysis.results.study_results import COMPARED_METHOD, STATED_RTOLS
from analysis.results.set_up import is_delta_self
from analysis.results.store import Document
from geometries.common.installation import module_folders
from geometries.scene.scene import Scene
from geometries.studies.families import GROUNDED

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
    answers = {method: _answer_or_refusal(module, scene, method) for method in methods}
    return {"format": 1, "version": str(module.__version__), "methods": answers}


def options(method: str) -> dict[str, Any]:
    """Returns the options of the model for a method of a study (`geometries.studies.study.METHODS`)."""
    accuracy = {"rtol": STATED_RTOLS[method], "entries": True} if method in STATED_RTOLS else {}
    return {"method": method, **accuracy}


def _answer_or_refusal(module: Any, scene: Path, method: str) -> Document:
    try:
        return _timed(module, scene, options(method))
    except ValueError as error:
        if method == COMPARED_METHOD:
            raise
        return {"refused": str(error).removeprefix(f"{scene}: ")}


def _timed(module: Any, scene: Path, asked: dict[str, Any]) -> Document:
    answers: list[Document] = []
    start = time.monotonic()
    while not answers or (len(answers) < _REPEATS and time.monotonic() - start < _MOST_SECONDS):
        # Each scene is loaded anew, because a scene keeps the results of what has not moved.
        answers.append(module.Scene.load(str(scene)).capacitance(**asked))
    kept = {name: answers[0][name] for name in ("sensors", "readings")}
    return {"seconds": min(answer["seconds"] for answer in answers), **kept}
