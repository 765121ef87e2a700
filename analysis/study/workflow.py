"""From a study to its stored answers: what is there under the right key stays, the rest is computed."""

from __future__ import annotations

from pathlib import Path

from analysis.pipeline import boundary_stage, measurement_stage, model_stage, reference_stage
from analysis.pipeline.jobs import Job, parallel_jobs, run_all
from analysis.results.store import is_current, read_current, write_text
from analysis.results.study_results import (
    BOUNDARY,
    MODEL,
    REFERENCE,
    SCENE,
    SLICE,
    Failure,
    case_folder,
    write_manifest,
)
from analysis.study import plan
from analysis.study.plan import Work
from analysis.topics.trade_off import stage as trade_off
from geometries.studies.study import Study


def run(study: Study, folder: Path, workers: int | None, measure_model: bool = False) -> list[Failure]:
    """Bring every case of the study up to date in `folder`; returns the failures, which are written down there too.

    With `measure_model` the measurements of the model by itself, too. Those that are out of date are removed in any case.

    KeyboardInterrupt ends it at once; what was finished stays.
    """
    cases = study.cases()
    works = plan.missing(study, cases, folder)
    forget(works, folder)
    failures = evaluate_model(works, study.methods, folder) + measure(folder, measure_model)
    failures += solve_by_boundary_elements(works, study, folder)
    failures += solve(works, study, folder, workers or parallel_jobs())
    # The pairs of plates are found in the manifest.
    write_manifest(folder, study, failures)
    measured = trade_off.run(folder, [case.identity for case in cases], measure_model)
    if measured:
        failures += measured
        write_manifest(folder, study, failures)
    return failures


def forget(works: list[Work], folder: Path) -> None:
    """Remove the outdated answers of what is to do, so that no report shows them, and what killed writers left there."""
    for work in works:
        place = case_folder(folder, work.case)
        if not place.is_dir():
            continue
        for file in work.keys:
            (place / file).unlink(missing_ok=True)
        for unfinished in place.glob(".*"):
            unfinished.unlink(missing_ok=True)


def write_scenes(works: list[Work], folder: Path) -> None:
    """Write down the scenes that are not there."""
    for work in works:
        scene = case_folder(folder, work.case) / SCENE
        if not scene.is_file():
            write_text(scene, work.scene)


def evaluate_model(works: list[Work], methods: tuple[str, ...], folder: Path) -> list[Failure]:
    """Write down the scenes and the model's answers that are to do, one after the other, since their times are measured."""
    write_scenes(works, folder)
    failures = []
    for work in works:
        scene = case_folder(folder, work.case) / SCENE
        target = scene.with_name(MODEL)
        if MODEL in work.keys and not is_current(target, work.keys[MODEL]):
            module = model_stage.model_module()
            failure = model_stage.evaluate(scene, target, work.keys[MODEL], methods, module)
            failures += [failure] if failure else []
    return failures


def solve_by_boundary_elements(works: list[Work], study: Study, folder: Path) -> list[Failure]:
    """Make the boundary elements' answers that are to do, milliseconds each; the scenes are there."""
    failures = []
    for work in works:
        scene = case_folder(folder, work.case) / SCENE
        target = scene.with_name(BOUNDARY)
        if BOUNDARY in work.keys and not is_current(target, work.keys[BOUNDARY]):
            module = model_stage.model_module()
            failure = boundary_stage.evaluate(scene, target, work.keys[BOUNDARY], study.rtol, module)
            failures += [failure] if failure else []
    return failures


def solve(works: list[Work], study: Study, folder: Path, workers: int, shown: bool = True) -> list[Failure]:
    """Make the reference's answers and slices that are to do, so many at a time, with a progress bar if `shown`."""
    jobs = [
        _reference_job(file, work, study, case_folder(folder, work.case))
        for work in works
        for file in (REFERENCE, SLICE)
        if file in work.keys
    ]
    if not jobs:
        return []
    try:
        return run_all(jobs, workers, shown=shown)
    except BaseException:
        reference_stage.forget_unfinished_forms()
        raise


def measure(folder: Path, wanted: bool) -> list[Failure]:
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


def _reference_job(file: str, work: Work, study: Study, place: Path) -> Job:
    scene, target, key = place / SCENE, place / file, work.keys[file]
    if file == SLICE:
        return Job(work.seconds[file], lambda processes: reference_stage.cut(scene, target, key, processes))
    return Job(
        work.seconds[file],
        lambda processes: reference_stage.solve(scene, target, key, study, processes),
    )
