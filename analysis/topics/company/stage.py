"""Computes the reading of each set-up by boundary elements, and the model's change of it; finished set-ups are not computed again."""

from __future__ import annotations

import functools
from pathlib import Path
from time import perf_counter
from typing import Any

from analysis.pipeline import keys, model_stage
from analysis.pipeline.processes import Processes
from analysis.pipeline.scheduler import parallel_jobs, run_all
from analysis.pipeline.stage import Stage, outdated
from analysis.results.store import Document, read_current, write_text
from analysis.results.study_results import SCENE, Failure, case_folder
from analysis.results.table import COMPARED_METHOD
from analysis.topics.company import set_ups
from analysis.topics.company.set_ups import GUARD, SENSOR, SetUp
from geometries.common.installation import ROOT
from geometries.studies.families import GROUNDED

FOLDER = "company"
"""The folder of the answers, beside the folders of the studies' results."""
ANSWER = "company.json"
RTOL = 1e-3
"""Relative accuracy asked of the reading's value, background and change."""
# Expected seconds with a guard, whose edge is close to the sensor's and the housing, and without.
_SECONDS_GUARDED, _SECONDS = 2.0, 0.2


def beside(results: Path) -> Path:
    """Returns the folder of this experiment that belongs to a study's results."""
    return results.resolve().parent / FOLDER


def run(folder: Path, chosen: tuple[SetUp, ...], workers: int | None = None) -> list[Failure]:
    """Computes the missing and outdated answers; returns the failures."""
    current = code()
    stages = outdated([stage(folder, set_up, current) for set_up in chosen])
    return run_all(stages, workers or parallel_jobs(), "set-ups in company")


def stage(folder: Path, set_up: SetUp, code: str) -> Stage:
    """Returns the stage of one set-up."""
    target = case_folder(folder, set_up.id) / ANSWER
    answer = functools.partial(_answer, set_up, target.with_name(SCENE))
    seconds = _SECONDS_GUARDED if set_up.machine == GUARD else _SECONDS
    return Stage("company", set_up.id, target, key(set_up.identity, code), seconds, answer)


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
    """Returns the version of the code that makes the answers: the model with its boundary elements, and this stage."""
    own = repository / "analysis" / "topics" / "company" / "stage.py"
    return f"{keys.model_code(repository)} {keys.hash_of_files([own], repository)}"


def key(identity: str, code: str) -> str:
    """Returns the key of a set-up's answer."""
    return keys.measurement_key(f"company {identity} {RTOL}", code, {})


def answer(model: Any, scene: Path, grounded: bool) -> Document:
    """Computes value, background and change (F) with their errors; and `model`, the model's change, which knows only grounded hands."""
    before = perf_counter()
    reading = model.Scene.load(str(scene)).readings("boundary-elements", rtol=RTOL)[SENSOR]
    seconds = perf_counter() - before
    quantities = {
        name: {"value": float(getattr(reading, name)), "error": float(reading.error[name])}
        for name in ("value", "background", "change")
    }
    by_model = model.Scene.load(str(scene)).readings(COMPARED_METHOD)[SENSOR] if grounded else None
    return {"seconds": seconds, **quantities, "model": float(by_model.change) if by_model else None}


def _answer(set_up: SetUp, scene: Path, _: Processes) -> Document:
    if not scene.is_file():
        write_text(scene, set_up.text)
    return answer(model_stage.model_module(), scene, set_up.ground == GROUNDED)
