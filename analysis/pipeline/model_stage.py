"""The model's answers for one case, by every method, with the time of each."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from typing import Any

from analysis.results import changes
from analysis.results.store import Document
from geometries.common.installation import module_folders
from geometries.scene.scene import Scene
from geometries.studies.families import GROUNDED

NAME = "model"
# Evaluations per method. Each takes about a microsecond, so the smallest of many times is stored.
_REPEATS = 25


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


def knows(scene: Scene) -> bool:
    """Tells whether the model applies: it needs conductors, grounded ones unless its answer says which changes it does not know."""
    if any(body.relative_permittivity is not None for body in scene.objects):
        return False
    return not changes.is_delta_self(scene) or all(body.potential == GROUNDED for body in scene.objects)


def answer(scene: Path, methods: tuple[str, ...]) -> Document:
    """Evaluates a scene file by every method."""
    module = model_module()
    answers = {method: _timed(module, scene, method) for method in methods}
    return {"format": 1, "version": str(module.__version__), "methods": answers}


def _timed(module: Any, scene: Path, method: str) -> Document:
    # Each scene is loaded anew, because a scene keeps the results of what has not moved.
    answers = [module.Scene.load(str(scene)).capacitance(method=method) for _ in range(_REPEATS)]
    kept = {name: answers[0][name] for name in ("sensors", "readings")}
    return {"seconds": min(answer["seconds"] for answer in answers), **kept}
