"""From a study to its stored answers: what is there under the right key stays, the rest is computed."""

from __future__ import annotations

from pathlib import Path

from analysis import keys, measurement_stage, model_stage, reference_stage, set_up
from analysis.jobs import Failure, Job, parallel_jobs, run_all
from analysis.results import MODEL, REFERENCE, SCENE, SLICE, case_folder, write_manifest
from analysis.store import read_current, write_text
from geometries.study import EMPTY, Case, Study
from geometries.writer import canonical

# Seconds that a case takes on one core of 2020, roughly: only their ratios count, for the order and the progress bar.
_SECONDS_EMPTY, _SECONDS_PAIR, _SECONDS_PER_SIZE_OVER_GAP, _SECONDS_SLICE = 4.0, 12.0, 1.0, 4.0


def run(study: Study, folder: Path, workers: int | None, measure_model: bool = False) -> list[Failure]:
    """Bring every case of the study up to date in `folder`; returns the failures, which are written down there too.

    With `measure_model` the measurements of the model by itself, too. Those that are out of date are removed in any case.

    KeyboardInterrupt ends it at once; what was finished stays.
    """
    cases = study.cases()
    for case in cases:
        path = case_folder(folder, case.id) / SCENE
        if not path.is_file():
            write_text(path, canonical(case.scene))
    failures = _evaluate_model(study, cases, folder) + _measure_model(folder, measure_model)
    jobs = _reference_jobs(study, cases, folder)
    if jobs:
        try:
            failures += run_all(jobs, workers or parallel_jobs())
        except BaseException:
            reference_stage.forget_unfinished_forms()
            raise
    write_manifest(folder, study, failures)
    return failures


def _evaluate_model(study: Study, cases: list[Case], folder: Path) -> list[Failure]:
    code = keys.model_code()
    failures = []
    for case in cases:
        target = case_folder(folder, case.id) / MODEL
        key = keys.model_key(case.scene, study, code)
        if case.family == EMPTY or read_current(target, key) is not None:
            continue
        target.unlink(missing_ok=True)
        module = model_stage.model_module()
        failure = model_stage.evaluate(target.with_name(SCENE), target, key, study.methods, module)
        failures += [failure] if failure else []
    return failures


def _measure_model(folder: Path, wanted: bool) -> list[Failure]:
    """One measurement after the other, and nothing beside them: what runs at the same time would spoil the times."""
    jobs = []
    for measurement in measurement_stage.MEASUREMENTS:
        target, key = folder / measurement.file, measurement_stage.key(measurement)
        if read_current(target, key) is None:
            target.unlink(missing_ok=True)
            jobs.append(_measurement_job(measurement, target, key))
    return run_all(jobs, 1, "measurements of the model") if wanted and jobs else []


def _measurement_job(measurement: measurement_stage.Measurement, target: Path, key: str) -> Job:
    return Job(
        measurement.seconds,
        lambda processes: measurement_stage.measure(measurement, target, key, processes),
    )


def _reference_jobs(study: Study, cases: list[Case], folder: Path) -> list[Job]:
    """A job for every answer and every slice that is missing or out of date; the outdated files are removed."""
    code = keys.reference_code()
    jobs = []
    for case in cases:
        target = case_folder(folder, case.id) / REFERENCE
        key = keys.reference_key(case.scene, study, code)
        if read_current(target, key) is None:
            target.unlink(missing_ok=True)
            jobs.append(_solve_job(case, study, target, key))
    for case in _pictured(cases):
        target = case_folder(folder, case.id) / SLICE
        key = keys.slice_key(case.scene, code)
        if read_current(target, key) is None:
            target.unlink(missing_ok=True)
            jobs.append(_slice_job(target, key))
    return jobs


def _pictured(cases: list[Case]) -> list[Case]:
    """One case for each family, the second of its list where it can be: the first of a sweep is its extreme."""
    families = dict.fromkeys(case.family for case in cases if case.family != EMPTY)
    of_family = ([case for case in cases if case.family == family] for family in families)
    return [members[min(1, len(members) - 1)] for members in of_family]


def _solve_job(case: Case, study: Study, target: Path, key: str) -> Job:
    scene = target.with_name(SCENE)
    return Job(
        _expected_seconds(case),
        lambda processes: reference_stage.solve(scene, target, key, study, processes),
    )


def _slice_job(target: Path, key: str) -> Job:
    scene = target.with_name(SCENE)
    return Job(
        _SECONDS_SLICE,
        lambda processes: reference_stage.cut(scene, target, key, processes),
    )


def _expected_seconds(case: Case) -> float:
    if case.family == EMPTY:
        return _SECONDS_EMPTY
    described = set_up.describe(case.scene)
    if described is None or described.gap == 0:
        return _SECONDS_PAIR
    return _SECONDS_PAIR + _SECONDS_PER_SIZE_OVER_GAP * described.largest_size / described.gap
