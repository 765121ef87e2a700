"""Plans a study: finds the answers that are missing or stored under an outdated key."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from analysis.pipeline import boundary_stage, keys
from analysis.pipeline.model_stage import knows
from analysis.results import set_up
from analysis.results.store import is_current
from analysis.results.study_results import BOUNDARY, MODEL, REFERENCE, SCENE, SLICE, case_folder
from geometries.studies.study import EMPTY, Case, Study

# Approximate seconds per case on one core of 2020. Only their ratios matter, for the order and the progress bar.
_SECONDS_EMPTY, _SECONDS_PAIR, _SECONDS_PER_SIZE_OVER_GAP, _SECONDS_SLICE = 4.0, 12.0, 1.0, 4.0
_SECONDS_MACHINE = 35.0
_SECONDS_MODEL, _SECONDS_BOUNDARY = 0.1, 0.1
# Run time of proven intervals relative to estimated errors.
_ENCLOSURE_FACTOR = 3.0
# From this number of cases on, all are expected to take equally long: estimating each would take longer than it saves.
_MANY_CASES = 5000
# Up to this number of cases, every case gets a slice of the potential; each takes three to five seconds.
_ALL_PICTURED = 100


@dataclass(frozen=True)
class Work:
    """The missing answers of one case: `keys` and the expected `seconds` for each of the files model.json, boundary.json, fem.json and
    slice.json that is missing; `alone` is that of the case."""

    case: str
    scene: str
    alone: float | None
    keys: dict[str, str]
    seconds: dict[str, float]

    @property
    def cost(self) -> float:
        return sum(self.seconds.values())


def missing(study: Study, cases: list[Case], folder: Path) -> list[Work]:
    """Returns what is to do so that every case is up to date in `folder`; nothing is changed there."""
    model, reference = keys.model_code(), keys.reference_code()
    there = _case_folders(folder)
    pictured = _pictured(cases) if study.by_field else set()
    costs_vary = len(cases) < _MANY_CASES
    found = []
    for case in cases:
        wanted = {}
        if study.by_field and case.alone is None:
            wanted[REFERENCE] = keys.reference_key(case.identity, study, reference)
        if study.by_boundary_elements:
            asked = boundary_stage.rtol(study, case.scene, case.alone)
            wanted[BOUNDARY] = keys.boundary_key(case.identity, asked, model)
        if case.family != EMPTY and knows(case.scene):
            wanted[MODEL] = keys.model_key(case.identity, study, model)
        if case.id in pictured:
            wanted[SLICE] = keys.slice_key(case.identity, reference)
        place = case_folder(folder, case.id)
        if case.id in there:
            wanted = {file: key for file, key in wanted.items() if not is_current(place / file, key)}
            if not wanted and (place / SCENE).is_file():
                continue
        seconds = {file: _expected_seconds(case, file, study, costs_vary) for file in wanted}
        found.append(Work(case.id, case.text, case.alone, wanted, seconds))
    return found


def _case_folders(folder: Path) -> set[str]:
    try:
        return set(os.listdir(folder / "cases"))
    except FileNotFoundError:
        return set()


def _pictured(cases: list[Case]) -> set[str]:
    """Returns the cases that get a slice of the potential: all of a small study, one for each family of a large one, if possible the
    second of its list, because the first of a sweep is its extreme."""
    members: dict[str, list[str]] = {}
    for case in cases:
        if case.family != EMPTY and case.alone is None:
            members.setdefault(case.family, []).append(case.id)
    if len(cases) <= _ALL_PICTURED:
        return {case for ids in members.values() for case in ids}
    return {ids[min(1, len(ids) - 1)] for ids in members.values()}


def _expected_seconds(case: Case, file: str, study: Study, costs_vary: bool) -> float:
    if file == MODEL:
        return _SECONDS_MODEL
    if file == BOUNDARY:
        return _SECONDS_BOUNDARY
    if file == SLICE:
        return _SECONDS_SLICE
    factor = _ENCLOSURE_FACTOR if study.error == "enclosure" else 1.0
    return factor * (_solve_seconds(case) if costs_vary else _SECONDS_PAIR)


def _solve_seconds(case: Case) -> float:
    if case.family == EMPTY:
        return _SECONDS_EMPTY
    if not set_up.is_delta_self(case.scene):
        return _SECONDS_MACHINE
    described = set_up.describe(case.scene)
    if described is None or described.gap == 0:
        return _SECONDS_PAIR
    return _SECONDS_PAIR + _SECONDS_PER_SIZE_OVER_GAP * described.largest_size / described.gap
