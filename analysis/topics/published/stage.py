"""What the table is made from: bounds and best values of each set-up, kept under keys; what is there is not done again."""

from __future__ import annotations

import functools
import json
import os
import sys
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any

from analysis.pipeline import keys, model_stage, reference_stage
from analysis.pipeline.jobs import Job, parallel_jobs, run_all
from analysis.pipeline.keys import REPOSITORY
from analysis.pipeline.processes import Processes
from analysis.results.store import Document, is_current, read_current, write_json, write_text
from analysis.results.study_results import REFERENCE, SCENE, Failure, case_folder
from geometries.studies import study
from geometries.studies.study import EMPTY, Case, Study

FOLDER = "published"
"""Of the answers, beside the folders of the studies' results."""
STUDY = "published"
UPPER, BOUNDARY = "upper.json", "boundary.json"

REFINEMENT = 2.0
"""Of the mesh for an upper bound, over the field solver's coarsest: seconds for each set-up."""
REFINEMENT_ALONE = 16.0
"""The same for the sensor alone, which every delta_self is measured against."""
RTOLS = (5e-5, 2e-5, 1e-5)
"""Asked of boundary elements, one after the other, until four digits of every quantity are sure."""
FOUR_DIGITS = 5e-5
CHECKED_EACH = 60
"""One set-up in so many is also solved by the field solver as in any study."""

# The command that solves several scenes loads and compiles for seconds first.
_CASES_PER_PROCESS = 8
_SECONDS_UPPER, _SECONDS_CHECK, _SECONDS_BOUNDARY = 3.0, 12.0, 0.5


def cases() -> list[Case]:
    """The set-ups, and at last the sensor alone."""
    return _asked().cases()


def checked(found: list[Case]) -> list[Case]:
    """The set-ups that the field solver checks."""
    return [case for case in found if case.family != EMPTY][::CHECKED_EACH]


def run(folder: Path, workers: int | None = None) -> list[Failure]:
    """Do what is missing or out of date; returns the failures."""
    found = cases()
    for case in found:
        scene = case_folder(folder, case.id) / SCENE
        if not scene.is_file():
            write_text(scene, case.text)
    jobs = [*_boundary_jobs(folder, found), *_upper_jobs(folder, found), *_checks(folder, found)]
    try:
        return run_all(jobs, workers or parallel_jobs(), "parts of the table") if jobs else []
    except BaseException:
        reference_stage.forget_unfinished_forms()
        raise


def load(folder: Path, case: Case, file: str) -> Document | None:
    """What is stored of a case and made by today's code."""
    return read_current(case_folder(folder, case.id) / file, _key(case, file))


def boundary(module: Any, scene: Path) -> Document:
    """Maxwell matrix and delta_self by boundary elements, as strict as four digits of every quantity take."""
    loaded = module.Scene.load(str(scene))
    for rtol in RTOLS:
        solved = loaded.maxwell(rtol=rtol)
        if not solved["reached"] or worst_error(solved) <= FOUR_DIGITS:
            break
    return {
        "maxwell": solved["maxwell"].tolist(),
        "error": solved["error"].tolist(),
        "lower_bounds": list(solved["lower_bounds"]),
        "delta_self": solved["delta_self"]["sensor"],
        "rtol": rtol,
        "reached": bool(solved["reached"]),
        "seconds": float(solved["seconds"]),
    }


def worst_error(solved: Document) -> float:
    """The largest stated error of what the table holds, relative to each; of a sensor alone that of its own entry."""
    errors = [solved["error"][i][j] / abs(solved["maxwell"][i][j]) for i, j in _entries(solved["maxwell"])]
    if len(solved["maxwell"]) > 1:
        change = solved["delta_self"]["sensor"]
        errors.append(change["error"] / change["value"])
    return float(max(errors))


def _entries(matrix: Any) -> list[tuple[int, int]]:
    return [(i, j) for i in range(len(matrix)) for j in range(i, len(matrix))]


def _asked() -> Study:
    return study.load(study.find(STUDY))


def _boundary_jobs(folder: Path, found: list[Case]) -> list[Job]:
    return [
        Job(_SECONDS_BOUNDARY, functools.partial(_solve_boundary, place, key))
        for place, key in _missing(folder, found, BOUNDARY)
    ]


def _solve_boundary(place: Path, key: str, _: Processes) -> Failure | None:
    try:
        answer = boundary(model_stage.model_module(), place / SCENE)
    except (ValueError, RuntimeError) as error:
        return Failure(place.name, "boundary elements", str(error))
    write_json(place / BOUNDARY, {"key": key, **answer})
    return None


def _upper_jobs(folder: Path, found: list[Case]) -> Iterator[Job]:
    missing = _missing(folder, found, UPPER)
    alone = {case_folder(folder, case.id) for case in found if case.family == EMPTY}
    works = iter(
        {
            "scene": str(place.resolve() / SCENE),
            "target": str(place.resolve() / UPPER),
            "key": key,
            "refinement": REFINEMENT_ALONE if place in alone else REFINEMENT,
        }
        for place, key in missing
    )
    while chunk := list(islice(works, _CASES_PER_PROCESS)):
        yield Job(_SECONDS_UPPER * len(chunk), functools.partial(_solve_upper, chunk))


def _solve_upper(chunk: list[Document], processes: Processes) -> Failure | None:
    command = [sys.executable, "-P", "-m", "analysis.topics.published.upper_bound", json.dumps(chunk)]
    environment = os.environ | {
        "OMP_NUM_THREADS": "1",
        "XDG_CACHE_HOME": str(REPOSITORY / "build" / "cache"),
        "PYTHONPATH": os.pathsep.join(filter(None, [str(REPOSITORY), os.environ.get("PYTHONPATH", "")])),
    }
    finished = processes.run(command, REPOSITORY, environment)
    if finished.exit_code == 0:
        return None
    told = (finished.errors.strip() or "no message").splitlines()[-1]
    lost = next((work for work in chunk if not is_current(Path(work["target"]), work["key"])), chunk[-1])
    return Failure(Path(lost["scene"]).parent.name, "upper bound", told)


def _checks(folder: Path, found: list[Case]) -> list[Job]:
    return [
        Job(_SECONDS_CHECK, functools.partial(_solve_check, place, key))
        for place, key in _missing(folder, checked(found), REFERENCE)
    ]


def _solve_check(place: Path, key: str, processes: Processes) -> Failure | None:
    return reference_stage.solve(place / SCENE, place / REFERENCE, key, _check_study(), processes)


def _check_study() -> Study:
    """Estimated errors: proven ones are in the table already."""
    return replace(_asked(), error="estimate")


def _missing(folder: Path, found: list[Case], file: str) -> list[tuple[Path, str]]:
    """The folders of the cases without an answer of today, with the key that it gets."""
    wanted = [(case_folder(folder, case.id), _key(case, file)) for case in found]
    return [(place, key) for place, key in wanted if not is_current(place / file, key)]


def _key(case: Case, file: str) -> str:
    if file == REFERENCE:
        return keys.reference_key(case.identity, _check_study(), _code(file))
    asked = (REFINEMENT, REFINEMENT_ALONE) if file == UPPER else RTOLS
    return keys.measurement_key(f"{file} {case.identity} {asked}", _code(file), {})


@functools.cache
def _code(file: str) -> str:
    """The version of what makes an answer; once, since there are hundreds."""
    if file == BOUNDARY:
        return keys.model_code()
    own = [] if file == REFERENCE else [REPOSITORY / "analysis" / "topics" / "published" / "upper_bound.py"]
    return keys.reference_code() + (keys.hash_of_files(own, REPOSITORY) if own else "")
