"""Solves each set-up by boundary elements and splits the model's error into parts; finished set-ups are not computed again."""

from __future__ import annotations

import functools
from dataclasses import asdict
from pathlib import Path
from typing import Any

from analysis.pipeline import keys, model_stage
from analysis.pipeline.processes import Processes
from analysis.pipeline.scheduler import parallel_jobs, run_all
from analysis.pipeline.stage import Stage, outdated
from analysis.results.answers import Estimate
from analysis.results.set_up import rectangles
from analysis.results.store import Document, read_current, write_text
from analysis.results.study_results import SCENE, Failure, case_folder
from analysis.topics.errors import parts, set_ups
from analysis.topics.errors.set_ups import SetUp
from geometries.common.installation import ROOT

FOLDER = "errors"
"""The folder of the answers, beside the folders of the studies' results."""
ANSWER = "errors.json"
RTOL = 1e-4
"""Relative accuracy asked of boundary elements: far below the parts, which matter from a per cent on."""
_SOURCES = ("paths.py", "parts.py", "stage.py")
# Expected seconds, the same for all set-ups: the run time cannot be predicted.
_SECONDS = 0.5


def beside(results: Path) -> Path:
    """Returns the folder of the errors that belongs to a study's results."""
    return results.resolve().parent / FOLDER


def run(folder: Path, chosen: tuple[SetUp, ...], workers: int | None = None) -> list[Failure]:
    """Computes the missing and outdated answers; returns the failures."""
    current = code()
    distinct = {each.id: each for each in chosen}.values()
    stages = outdated([stage(folder, set_up, current) for set_up in distinct])
    return run_all(stages, workers or parallel_jobs(), "set-ups taken apart")


def stage(folder: Path, set_up: SetUp, code: str) -> Stage:
    """Returns the stage of one set-up."""
    target = case_folder(folder, set_up.id) / ANSWER
    answer = functools.partial(_answer, set_up, target.with_name(SCENE))
    return Stage("errors", set_up.id, target, key(set_up.identity, code), _SECONDS, answer)


def load(folder: Path) -> dict[str, Document]:
    """Returns the answers in a folder that are up to date, by the set-up's id."""
    if not folder.is_dir():
        return {}
    current = code()
    found = {}
    for set_up in set_ups.all_set_ups():
        answer = read_current(case_folder(folder, set_up.id) / ANSWER, key(set_up.identity, current))
        if answer is not None:
            found[set_up.id] = answer
    return found


def code(repository: Path = ROOT) -> str:
    """Returns the version of the code that makes the answers: the model with its boundary elements, and this package's definitions."""
    own = keys.hash_of_files(
        [repository / "analysis" / "topics" / "errors" / name for name in _SOURCES]
        + [repository / "analysis" / "results" / "set_up.py"],
        repository,
    )
    return f"{keys.model_code(repository)} {own}"


def key(identity: str, code: str) -> str:
    """Returns the key of a set-up's answer."""
    return keys.measurement_key(f"errors {identity} {RTOL}", code, {})


def answer(model: Any, scene: Path, set_up: SetUp) -> Document:
    """Computes the truth with its error, and the parts of the model's error."""
    plates = rectangles(set_up.scene)
    assert plates is not None
    solved = model.Scene.load(str(scene)).maxwell(rtol=RTOL)
    sensor = set_up.scene.sensors[0].name
    truth = parts.Truth(
        mutual=Estimate(-float(solved["maxwell"][0][1]), float(solved["error"][0][1])),
        delta_self=Estimate(
            float(solved["delta_self"][sensor]["value"]), float(solved["delta_self"][sensor]["error"])
        ),
        target_own=Estimate(float(solved["maxwell"][1][1]), float(solved["error"][1][1])),
    )
    return {
        "reached": bool(solved["reached"]),
        "seconds": float(solved["seconds"]),
        "truth": asdict(truth),
        "split": asdict(parts.split(model, *plates)),
    }


def _answer(set_up: SetUp, scene: Path, _: Processes) -> Document:
    if not scene.is_file():
        write_text(scene, set_up.text)
    return answer(model_stage.model_module(), scene, set_up)
