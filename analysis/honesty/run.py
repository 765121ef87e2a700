"""Runs the league: asks every method for every scene, keeps the answers, and writes the table."""

import functools
import itertools
import queue
import random
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

from analysis.honesty import asking, judging
from analysis.honesty.asking import ALL, FIELD_SOLVER, FINER, METHODS, Answer, Worker
from analysis.honesty.judging import Judged, Record, judged
from analysis.honesty.kinds import KINDS, Drawn, drawn, seeds
from analysis.pipeline import keys, reference_stage
from analysis.pipeline.model_stage import model_module
from analysis.pipeline.scheduler import parallel_jobs, run_all
from analysis.pipeline.stage import NoAnswer, Processes, Refused
from analysis.results.answers import MatrixAnswer
from analysis.results.store import write_text
from analysis.results.study_results import Failure
from geometries.common import installation
from geometries.common.errors import InputError
from geometries.common.measured import picofarads

FOLDER, TABLE, MESHES = "honesty", "league.md", "meshes"
SCENES = 32 * len(KINDS)
"""Scenes, if no other number is asked for: as many of each kind."""
FIELD_SHARE = 0.05
"""Part of the scenes that the field solver is asked for, which takes up to a minute for one."""
SECONDS = 10.0
"""Most processor time for an answer of the library."""


@dataclass(frozen=True)
class Options:
    """What is asked: so many scenes of these kinds from the seed `first` on, by these methods, the field solver in a part of them."""

    scenes: int = SCENES
    first: int = 0
    kinds: tuple[str, ...] = tuple(KINDS)
    methods: tuple[str, ...] = ALL
    field_share: float = FIELD_SHARE
    seconds: float = SECONDS
    jobs: int | None = None


def options(kinds: str | None, of_methods: str | None, **more: object) -> Options:
    """Returns options of which names are lists with commas, as on the command line; InputError for one that is not known."""
    of_kinds, methods = _named("--kinds", kinds, tuple(KINDS)), _named("--methods", of_methods, ALL)
    return Options(kinds=of_kinds, methods=methods, **more)  # type: ignore[arg-type]


def _named(option: str, names: str | None, known: tuple[str, ...]) -> tuple[str, ...]:
    chosen = known if names is None else tuple(names.split(","))
    for name in chosen:
        if name not in known:
            raise InputError("", option, f"{name!r} is none of {', '.join(known)}")
    return chosen


@dataclass(frozen=True)
class League:
    """What a run has found: the table's rows and its file."""

    rows: list[judging.Row]
    path: Path
    text: str


def run(folder: Path, asked: Options) -> League:
    """Asks what has no answer yet in the folder, then writes the table; KeyboardInterrupt keeps all scenes that are finished."""
    model_module()
    stored, codes = judging.load(folder), (keys.model_code(), keys.reference_code())
    chosen = itertools.islice(seeds(asked.first, frozenset(asked.kinds)), asked.scenes)
    scenes = [drawn(seed, folder / MESHES) for seed in chosen]
    workers = asked.jobs or parallel_jobs()
    with ExitStack() as stack:
        idle: queue.SimpleQueue[Worker] = queue.SimpleQueue()
        for _ in range(workers):
            idle.put(stack.enter_context(Worker()))
        jobs = []
        for scene in scenes:
            record = stored.setdefault(scene.seed, _unanswered(scene))
            key = functools.cache(functools.partial(_key, scene, asked.seconds, *codes))
            jobs.append(_Scene(scene, record, key, asked, folder, idle))
        run_all([job for job in jobs if job.missing], workers, "scenes")
    wanted = (*asked.methods, FINER, FIELD_SOLVER)
    current = []
    for job in jobs:
        known = {method: each for method, each in job.record.answers.items() if method in wanted}
        answers = {method: each for method, each in known.items() if each.key == job.key(method)}
        current.append(replace(_unanswered(job.scene), answers=answers))
    found = judging.rows(current, asked.methods)
    text = judging.text(found, f"{installation.command('analysis')} honesty --only")
    write_text(folder / TABLE, text)
    return League(found, folder / TABLE, text)


def _unanswered(scene: Drawn) -> Record:
    return Record(scene.seed, scene.kind, scene.truths)


def show(seed: int, folder: Path, asked: Options) -> Iterator[str]:
    """Asks the methods for one scene, and returns its file and every answer, line by line, as they come."""
    scene = drawn(seed, folder / MESHES)
    yield f"# seed {seed}: {scene.kind}\n{scene.text}"
    record = _unanswered(scene)
    processes = Processes()
    with Worker() as worker:
        for method in _asked_of(scene, asked):
            record.answers[method] = answer = _ask(scene, method, asked, folder, worker, processes)
            yield f"{method}: {answer.outcome} in {answer.seconds:.1f} s{answer.reason and f': {answer.reason}'}"
            for name, each in answer.values.items():
                if each.value is not None:
                    known = each.error is not None and f"{picofarads(each.value, each.error)} pF"
                    yield f"  {name}: {known or 'error unknown'}"
    yield from (f"closed form\n  {name}: {each.in_picofarads} pF" for name, each in scene.truths.items())
    found = (each for method in record.answers if method != FINER for each in judged(record, method))
    yield from (judging.finding(each) for each in found if isinstance(each, Judged))


def _key(scene: Drawn, seconds: float, model: str, reference: str, method: str) -> str:
    """Returns the key of a method's answer: equal keys, equal answers. `model` and `reference` are the versions of the programs."""
    if method == FIELD_SOLVER:
        limits = asking.FIELD_RTOL, asking.FIELD_SECONDS
        return keys.measurement_key(f"{method} {scene.text} {limits}", reference, {})
    if method == FINER:
        limits = asking.FINER_RTOL, asking.FINER_SECONDS
        return keys.measurement_key(f"{method} {scene.finer} {limits}", model, {})
    return keys.measurement_key(f"{method} {scene.text} {(METHODS[method], seconds)}", model, {})


_SCENES = "scenes"
_LATE = "no level was finished within"


def field_answer(scene: Drawn, folder: Path, processes: Processes) -> Answer:
    """Answers a scene, which is written to a file in the folder, by the field solver's intervals."""
    file = folder / _SCENES / f"{scene.seed}.toml"
    write_text(file, scene.text)
    asked = ["--rtol", repr(asking.FIELD_RTOL), "--max-seconds", repr(asking.FIELD_SECONDS)]
    if scene.has_readings:
        asked.append("--only-readings")
    begin = time.monotonic()
    try:
        answer = MatrixAnswer.of(reference_stage.solve(file, processes, *asked))
    except NoAnswer as error:
        outcome = asking.LATE if _LATE in str(error) else asking.ENDED
        outcome = asking.REFUSED if isinstance(error, Refused) else outcome
        return Answer(outcome, time.monotonic() - begin, str(error))
    values = asking.matrix_values(answer.conductors, answer.maxwell, answer.error, FIELD_SOLVER)
    if scene.has_readings:
        values = {
            asking.part_of(name, part): asking.stated(each.value, each.error, FIELD_SOLVER)
            for name, reading in answer.readings.items()
            for part, each in vars(reading).items()
        }
    return Answer(asking.ANSWERED, time.monotonic() - begin, values=values)


def _asked_of(scene: Drawn, asked: Options) -> list[str]:
    """Returns the methods that are asked for a scene, with those that others are held against."""
    found = [method for method in asked.methods if method != FIELD_SOLVER]
    if FIELD_SOLVER in asked.methods and random.Random(f"field {scene.seed}").random() < asked.field_share:
        found.append(FIELD_SOLVER)
    return found if scene.truths else [*found, FINER]


def _ask(
    scene: Drawn, method: str, asked: Options, folder: Path, worker: Worker, processes: Processes
) -> Answer:
    if method == FIELD_SOLVER:
        return field_answer(scene, folder, processes)
    go_on = processes.refuse_to_go_on
    if method == FINER:
        limit = asking.FINER_SECONDS
        finer = {"method": asking.BOUNDARY_ELEMENTS, "rtol": asking.FINER_RTOL, "max_seconds": limit}
        return worker.ask(scene.finer, scene.has_readings, finer, 2 * limit, go_on)
    return worker.ask(scene.text, scene.has_readings, METHODS[method], asked.seconds, go_on)


@dataclass(frozen=True)
class _Scene:
    """The job of asking for what the record of a scene lacks; `key` returns that of a method's answer."""

    scene: Drawn
    record: Record
    key: Callable[[str], str]
    asked: Options
    folder: Path
    idle: queue.SimpleQueue[Worker]

    @property
    def missing(self) -> list[str]:
        """The methods that have not answered yet."""
        have = {method: answer.key for method, answer in self.record.answers.items()}
        asked = _asked_of(self.scene, self.asked)
        return [method for method in asked if have.get(method) != self.key(method)]

    @property
    def seconds(self) -> float:
        """The expected time: the same for all scenes, so that they are asked for in the order of their seeds."""
        return 2 * self.asked.seconds

    def run(self, processes: Processes) -> Failure | None:
        new = _unanswered(self.scene)
        worker = self.idle.get()
        try:
            for method in self.missing:
                answer = _ask(self.scene, method, self.asked, self.folder, worker, processes)
                new.answers[method] = replace(answer, key=self.key(method))
        finally:
            self.idle.put(worker)
        judging.append(self.folder, new)
        self.record.answers |= new.answers
        return None
