"""Computes bounds and best values of each set-up of the published table; finished answers are kept."""

from __future__ import annotations

import functools
import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from typing import Any

from analysis.pipeline import keys, model_stage, reference_stage
from analysis.pipeline.processes import Processes
from analysis.pipeline.scheduler import Job, parallel_jobs, run_all
from analysis.pipeline.stage import Stage, outdated
from analysis.results.store import Document, is_current, read_current, write_text
from analysis.results.study_results import REFERENCE, SCENE, Failure, case_folder
from geometries.common.installation import ROOT
from geometries.studies import study
from geometries.studies.study import EMPTY, Case, Study

FOLDER = "published"
"""The folder of the answers, beside the folders of the studies' results."""
STUDY = "published"
UPPER, BOUNDARY = "upper.json", "boundary.json"

REFINEMENT = 2.0
"""Refinement of the mesh for an upper bound, relative to the field solver's coarsest mesh."""
REFINEMENT_ALONE = 16.0
"""Refinement for the sensor alone, whose capacitance enters every delta_self."""
RTOLS = (5e-5, 2e-5, 1e-5)
"""Relative accuracies asked of boundary elements in turn, until every quantity is known to four digits."""
FOUR_DIGITS = 5e-5
CHECKED_EACH = 60
"""Every so many set-ups, one is also solved by the field solver as in any study."""

# Cases per process: each process first needs seconds for loading and compiling.
_CASES_PER_PROCESS = 8
_SECONDS_UPPER, _SECONDS_CHECK, _SECONDS_BOUNDARY = 3.0, 12.0, 0.5


def cases() -> list[Case]:
    """Returns the set-ups and, last, the sensor alone."""
    return _asked().cases()


def checked(found: list[Case]) -> list[Case]:
    """Returns the set-ups that the field solver checks."""
    return [case for case in found if case.family != EMPTY][::CHECKED_EACH]


def run(folder: Path, workers: int | None = None) -> list[Failure]:
    """Computes the missing and outdated answers; returns the failures."""
    found = cases()
    for case in found:
        scene = case_folder(folder, case.id) / SCENE
        if not scene.is_file():
            write_text(scene, case.text)
    jobs: list[Job] = [
        *_boundary_stages(folder, found),
        *_upper_bounds(folder, found),
        *_checks(folder, found),
    ]
    return run_all(jobs, workers or parallel_jobs(), "parts of the table")


def load(folder: Path, case: Case, file: str) -> Document | None:
    """Returns the stored answer of a case if today's code made it."""
    return read_current(case_folder(folder, case.id) / file, _key(case, file))


def boundary(module: Any, scene: Path) -> Document:
    """Computes Maxwell matrix and delta_self by boundary elements, as accurately as four digits of every quantity need."""
    loaded = module.Scene.load(str(scene))
    for rtol in RTOLS:
        solved: Document = loaded.maxwell(rtol=rtol)
        if not solved["reached"] or worst_error(solved) <= FOUR_DIGITS:
            break
    return solved


def worst_error(solved: Document) -> float:
    """Returns the largest relative stated error of the table's quantities; of a sensor alone, that of its own entry."""
    errors = [solved["error"][i][j] / abs(solved["maxwell"][i][j]) for i, j in _entries(solved["maxwell"])]
    if len(solved["maxwell"]) > 1:
        change = solved["delta_self"]["sensor"]
        errors.append(change["error"] / change["value"])
    return float(max(errors))


def _entries(matrix: Any) -> list[tuple[int, int]]:
    return [(i, j) for i in range(len(matrix)) for j in range(i, len(matrix))]


def _asked() -> Study:
    return study.load(study.find(STUDY))


def _boundary_stages(folder: Path, found: list[Case]) -> list[Stage]:
    def answer(scene: Path, _: Processes) -> Document:
        return boundary(model_stage.model_module(), scene)

    return _stages(folder, found, BOUNDARY, "boundary elements", _SECONDS_BOUNDARY, answer)


def _checks(folder: Path, found: list[Case]) -> list[Stage]:
    def answer(scene: Path, processes: Processes) -> Document:
        return reference_stage.answer(scene, _check_study(), processes)

    return _stages(folder, checked(found), REFERENCE, reference_stage.SOLVE, _SECONDS_CHECK, answer)


def _stages(
    folder: Path,
    found: list[Case],
    file: str,
    name: str,
    seconds: float,
    answer: Callable[[Path, Processes], Document],
) -> list[Stage]:
    """Returns the stages of the cases whose answers are missing or outdated."""
    places = [(case, case_folder(folder, case.id)) for case in found]
    return outdated(
        [
            Stage(
                name,
                case.id,
                place / file,
                _key(case, file),
                seconds,
                functools.partial(answer, place / SCENE),
            )
            for case, place in places
        ]
    )


@dataclass(frozen=True)
class UpperBounds:
    """A job that computes the upper bounds of several cases in one process, which stores each of them. `works` are the
    process's arguments."""

    works: tuple[Document, ...]

    @property
    def seconds(self) -> float:
        return _SECONDS_UPPER * len(self.works)

    def run(self, processes: Processes) -> Failure | None:
        """Computes the bounds; returns why the first missing one is missing."""
        finished = processes.run_module("analysis.topics.published.upper_bound", json.dumps(self.works))
        if finished.exit_code == 0:
            return None
        missing = (work for work in self.works if not is_current(Path(work["target"]), work["key"]))
        lost = Path(next(missing, self.works[-1])["target"])
        return Failure(lost.parent.name, "upper bound", finished.reason)


def _upper_bounds(folder: Path, found: list[Case]) -> Iterator[UpperBounds]:
    places = [(case, case_folder(folder, case.id).resolve(), _key(case, UPPER)) for case in found]
    works = iter(
        {
            "scene": str(place / SCENE),
            "target": str(place / UPPER),
            "key": key,
            "refinement": REFINEMENT_ALONE if case.family == EMPTY else REFINEMENT,
        }
        for case, place, key in places
        if not is_current(place / UPPER, key)
    )
    while chunk := tuple(islice(works, _CASES_PER_PROCESS)):
        yield UpperBounds(chunk)


def _check_study() -> Study:
    """Asks for estimated errors: the table holds proven ones already."""
    return replace(_asked(), error="estimate")


def _key(case: Case, file: str) -> str:
    if file == REFERENCE:
        return keys.reference_key(case.identity, _check_study(), _code(file))
    asked = (REFINEMENT, REFINEMENT_ALONE) if file == UPPER else RTOLS
    return keys.measurement_key(f"{file} {case.identity} {asked}", _code(file), {})


@functools.cache
def _code(file: str) -> str:
    """Returns the version of the code that makes an answer; cached, because it is needed for hundreds of cases."""
    if file == BOUNDARY:
        return keys.model_code()
    own = [] if file == REFERENCE else [ROOT / "analysis" / "topics" / "published" / "upper_bound.py"]
    return keys.reference_code() + (keys.hash_of_files(own, ROOT) if own else "")
