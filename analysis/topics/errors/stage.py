"""Each set-up solved by boundary elements and its error taken apart, kept under a key: finished set-ups are not done again."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

from analysis.pipeline import keys, model_stage
from analysis.pipeline.jobs import Job, parallel_jobs, run_all
from analysis.pipeline.keys import REPOSITORY
from analysis.pipeline.processes import Processes
from analysis.results.answers import Estimate
from analysis.results.set_up import rectangles
from analysis.results.store import Document, is_current, read_current, write_json, write_text
from analysis.results.study_results import SCENE, Failure, case_folder
from analysis.topics.errors import parts, set_ups
from analysis.topics.errors.set_ups import SetUp

FOLDER = "errors"
"""Of the answers, beside the folders of the studies' results."""
ANSWER = "errors.json"
RTOL = 1e-4
"""Asked of boundary elements: far below the parts, which matter to a per cent."""
_SOURCES = ("paths.py", "parts.py", "stage.py")
# All are alike to the progress bar: what takes long cannot be told before.
_SECONDS = 0.5


def beside(results: Path) -> Path:
    """The folder of the errors that belongs to a study's results."""
    return results.resolve().parent / FOLDER


def run(folder: Path, chosen: tuple[SetUp, ...], workers: int | None = None) -> list[Failure]:
    """Do what is missing or out of date; returns the failures."""
    current = code()
    jobs = []
    for set_up in {each.id: each for each in chosen}.values():
        target, key_ = case_folder(folder, set_up.id) / ANSWER, key(set_up.identity, current)
        if not is_current(target, key_):
            # With what killed writers left there.
            for outdated in (target, *target.parent.glob(".*")):
                outdated.unlink(missing_ok=True)
            jobs.append(_job(set_up, target, key_))
    return run_all(jobs, workers or parallel_jobs(), "set-ups taken apart") if jobs else []


def load(folder: Path) -> dict[str, Document]:
    """The answers in a folder that are up to date, by the set-up's id."""
    if not folder.is_dir():
        return {}
    current = code()
    found = {}
    for set_up in set_ups.all_set_ups():
        answer = read_current(case_folder(folder, set_up.id) / ANSWER, key(set_up.identity, current))
        if answer is not None:
            found[set_up.id] = answer
    return found


def code(repository: Path = REPOSITORY) -> str:
    """The version of what answers are made by: the model with its boundary elements, and this package's definitions."""
    own = keys.hash_of_files(
        [repository / "analysis" / "topics" / "errors" / name for name in _SOURCES]
        + [repository / "analysis" / "results" / "set_up.py"],
        repository,
    )
    return f"{keys.model_code(repository)} {own}"


def key(identity: str, code: str) -> str:
    """The key of a set-up's answer."""
    return keys.measurement_key(f"errors {identity} {RTOL}", code, {})


def answer(model: Any, scene: Path, set_up: SetUp) -> Document:
    """The truth with its error, and the split."""
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


def _job(set_up: SetUp, target: Path, key: str) -> Job:
    return Job(_SECONDS, lambda processes: _solve(set_up, target, key, processes))


def _solve(set_up: SetUp, target: Path, key: str, _: Processes) -> Failure | None:
    scene = target.with_name(SCENE)
    if not scene.is_file():
        write_text(scene, set_up.text)
    try:
        found = answer(model_stage.model_module(), scene, set_up)
    except (ValueError, RuntimeError) as error:
        return Failure(set_up.id, "errors", str(error))
    write_json(target, {"key": key, **found})
    return None
