"""Computes a study's answers; those stored under the right key are kept."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from analysis.pipeline import boundary_stage, measurement_stage, model_stage, reference_stage
from analysis.pipeline.scheduler import parallel_jobs, run_all
from analysis.pipeline.stage import Stage, outdated
from analysis.results.store import write_text
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
from analysis.topics.trade_off import measure as trade_off
from geometries.studies.study import Study


def run(
    study: Study,
    folder: Path,
    workers: int | None,
    measure_model: bool = False,
    before_pictures: Callable[[], None] = lambda: None,
) -> list[Failure]:
    """Brings every case of the study up to date in `folder`; returns the failures, which are written down there too.

    With `measure_model` the model is also measured by itself. Outdated measurements are removed in any case. `before_pictures` is called
    when every answer is there and slices of the potential, which only pictures need, are still to be solved.

    KeyboardInterrupt ends it at once; finished answers are kept.
    """
    cases = study.cases()
    works = plan.missing(study, cases, folder)
    forget(works, folder)
    failures = measure(folder, measure_model)
    failures += answers(works, study, folder, workers or parallel_jobs())
    # The trade-off reads the pairs of plates from the manifest.
    write_manifest(folder, study, failures)
    late = trade_off.run(folder, [case.identity for case in cases], measure_model)
    pictures = stages(works, study, folder, (SLICE,))
    if pictures:
        before_pictures()
        late += run_all(pictures, workers or parallel_jobs(), "pictures of the potential")
    if late:
        failures += late
        write_manifest(folder, study, failures)
    return failures


def forget(works: list[Work], folder: Path) -> None:
    """Removes outdated answers, so that no report shows them, and the unfinished files of killed writers."""
    for work in works:
        place = case_folder(folder, work.case)
        if not place.is_dir():
            continue
        for file in work.keys:
            (place / file).unlink(missing_ok=True)
        for unfinished in place.glob(".*"):
            unfinished.unlink(missing_ok=True)


def write_scenes(works: list[Work], folder: Path) -> None:
    """Writes the scenes that are missing."""
    for work in works:
        scene = case_folder(folder, work.case) / SCENE
        if not scene.is_file():
            write_text(scene, work.scene)


def compute(work: Work, study: Study, folder: Path) -> list[Failure]:
    """Computes what is missing of one case, without a progress bar."""
    failures = answers([work], study, folder, workers=1, shown=False)
    return failures + run_all(stages([work], study, folder, (SLICE,)), 1, shown=False)


def answers(works: list[Work], study: Study, folder: Path, workers: int, shown: bool = True) -> list[Failure]:
    """Computes the missing answers: first, one after the other because their times are stored, those of the model and of boundary
    elements, then the reference's, `workers` at a time, with a progress bar if `shown`."""
    write_scenes(works, folder)
    quick = run_all(stages(works, study, folder, (MODEL, BOUNDARY)), 1, shown=False)
    return quick + run_all(stages(works, study, folder, (REFERENCE,)), workers, shown=shown)


def stages(works: list[Work], study: Study, folder: Path, files: tuple[str, ...]) -> list[Stage]:
    """Returns the stages of the given files for all cases where they are missing."""
    found = [
        _stage(file, work, study, case_folder(folder, work.case))
        for file in files
        for work in works
        if file in work.keys
    ]
    return [stage for stage in found if not stage.is_current]


def _stage(file: str, work: Work, study: Study, place: Path) -> Stage:
    scene, target = place / SCENE, place / file
    name, answer = {
        MODEL: (model_stage.NAME, lambda _: model_stage.answer(scene, study.methods)),
        BOUNDARY: (boundary_stage.NAME, lambda _: boundary_stage.answer(scene, study, work.alone)),
        REFERENCE: (reference_stage.SOLVE, lambda processes: reference_stage.answer(scene, study, processes)),
        SLICE: (
            reference_stage.SLICE,
            lambda processes: reference_stage.answer_slice(scene, target, processes),
        ),
    }[file]
    return Stage(name, work.case, target, work.keys[file], work.seconds[file], answer)


def measure(folder: Path, wanted: bool) -> list[Failure]:
    """Measures the model by itself, one measurement at a time because others would disturb it; removes outdated ones."""
    stages = outdated(measurement_stage.stages(folder))
    return run_all(stages, 1, "measurements of the model") if wanted else []
