"""Computes a study's answers that are missing or stored under an outdated key."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from analysis.pipeline import keys, measurement_stage, model_stage, reference_stage
from analysis.pipeline.scheduler import parallel_jobs, run_all
from analysis.pipeline.stage import Stage, outdated
from analysis.results import set_up, study_results
from analysis.results.statistics import grouped
from analysis.results.store import is_current, write_text
from analysis.results.study_results import BOUNDARY, MODEL, REFERENCE, SCENE, SLICE, Failure, case_folder
from analysis.topics.trade_off import measure as trade_off
from geometries.studies.study import EMPTY, Case, Study

# Approximate seconds per case on one core of 2020. Only their ratios matter, for the order and the progress bar.
_SECONDS_EMPTY, _SECONDS_PAIR, _SECONDS_PER_SIZE_OVER_GAP, _SECONDS_SLICE = 4.0, 12.0, 1.0, 4.0
_SECONDS_MACHINE = 35.0
_SECONDS_MODEL, _SECONDS_BOUNDARY = 0.1, 0.1
# Run time of proven intervals relative to estimated errors.
_ENCLOSURE_FACTOR = 3.0
# A study of this many cases or more expects the same seconds for each: estimates for all would take longer than they save.
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
    there = {path.name for path in (folder / "cases").glob("*")}
    pictured = _pictured(cases) if study.by_field else set()
    costs_vary = len(cases) < _MANY_CASES
    found = []
    for case in cases:
        wanted = {}
        if study.by_field and case.alone is None:
            wanted[REFERENCE] = keys.reference_key(case.identity, study, reference)
        if study.by_boundary_elements:
            asked = model_stage.boundary_rtol(study, case.scene, case.alone)
            wanted[BOUNDARY] = keys.boundary_key(case.identity, asked, model)
        if case.family != EMPTY and model_stage.knows(case.scene):
            wanted[MODEL] = keys.model_key(case.identity, study, model)
        if case.id in pictured:
            wanted[SLICE] = keys.slice_key(case.identity, reference)
        place = case_folder(folder, case.id)
        if case.id in there:
            wanted = {file: key for file, key in wanted.items() if not is_current(place / file, key)}
            if not wanted and (place / SCENE).is_file():
                continue
        seconds = _expected_seconds(case, study, costs_vary and REFERENCE in wanted)
        found.append(Work(case.id, case.text, case.alone, wanted, {file: seconds[file] for file in wanted}))
    return found


def _pictured(cases: list[Case]) -> set[str]:
    """Returns the cases that get a slice of the potential: all of a small study, one for each family of a large one, if possible the
    second of its list, because the first of a sweep is its extreme."""
    solved = [case for case in cases if case.family != EMPTY and case.alone is None]
    if len(cases) <= _ALL_PICTURED:
        return {case.id for case in solved}
    return {own[:2][-1].id for own in grouped(solved, lambda case: case.family).values()}


def _expected_seconds(case: Case, study: Study, costs_vary: bool) -> dict[str, float]:
    factor = _ENCLOSURE_FACTOR if study.error == "enclosure" else 1.0
    solve = factor * (_solve_seconds(case) if costs_vary else _SECONDS_PAIR)
    return {MODEL: _SECONDS_MODEL, BOUNDARY: _SECONDS_BOUNDARY, REFERENCE: solve, SLICE: _SECONDS_SLICE}


def _solve_seconds(case: Case) -> float:
    if case.family == EMPTY:
        return _SECONDS_EMPTY
    if not set_up.is_delta_self(case.scene):
        return _SECONDS_MACHINE
    described = set_up.describe(case.scene)
    if described is None or described.gap == 0:
        return _SECONDS_PAIR
    largest = max(described.sensor_size, described.target_size)
    return _SECONDS_PAIR + _SECONDS_PER_SIZE_OVER_GAP * largest / described.gap


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

    KeyboardInterrupt ends it at once; finished answers are kept."""
    cases = study.cases()
    works = missing(study, cases, folder)
    forget(works, folder)
    failures = measure(folder, measure_model)
    failures += answers(works, study, folder, workers or parallel_jobs())
    # The trade-off reads the pairs of plates from the manifest.
    study_results.write_manifest(folder, study, failures)
    late = trade_off.run(folder, [case.identity for case in cases], measure_model)
    pictures = stages(works, study, folder, (SLICE,))
    if pictures:
        before_pictures()
        late += run_all(pictures, workers or parallel_jobs(), "pictures of the potential")
    if late:
        failures += late
        study_results.write_manifest(folder, study, failures)
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
    wanted = ((file, work) for file in files for work in works if file in work.keys)
    found = [_stage(file, work, study, case_folder(folder, work.case)) for file, work in wanted]
    return [stage for stage in found if not stage.is_current]


def _stage(file: str, work: Work, study: Study, place: Path) -> Stage:
    scene, target = place / SCENE, place / file
    name, answer = {
        MODEL: (model_stage.NAME, lambda _: model_stage.answer(scene, study.methods)),
        BOUNDARY: (
            model_stage.BOUNDARY_NAME,
            lambda _: model_stage.boundary_answer(scene, study, work.alone),
        ),
        REFERENCE: (reference_stage.SOLVE, lambda other: reference_stage.answer(scene, study, other)),
        SLICE: (reference_stage.SLICE, lambda other: reference_stage.answer_slice(scene, target, other)),
    }[file]
    return Stage(name, work.case, target, work.keys[file], work.seconds[file], answer)


def measure(folder: Path, wanted: bool) -> list[Failure]:
    """Measures the model by itself, one measurement at a time because others would disturb it; removes outdated ones."""
    stages = outdated(measurement_stage.stages(folder))
    return run_all(stages, 1, "measurements of the model") if wanted else []
