"""The golden file: set-ups with stored truths, taken by fixed strides, are asked one after the other, each by the methods that its kind allows. The file is compared
with an older one: the gate tells what moved, and what must not have."""

import fnmatch
import hashlib
import itertools
import json
import math
import random
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from analysis.honesty import asking, closed_forms, judging
from analysis.honesty.asking import CHANGE, Answer, Stated, Worker, part_of
from analysis.pipeline.model_stage import model_module
from analysis.pipeline.scheduler import run_all
from analysis.pipeline.stage import Processes
from analysis.results.answers import Estimate
from analysis.results.store import markdown_table, read_json, write_json
from analysis.results.study_results import Failure
from analysis.topics.company import set_ups as company
from analysis.topics.corrections import set_ups as corrections
from analysis.topics.insulators import set_ups as insulators
from analysis.topics.machines import set_ups as machines, truths as machines_truths
from geometries.common.errors import InputError
from geometries.common.measured import picofarads
from geometries.scene.scene import Scene
from geometries.scene.writer import canonical_and_identity
from geometries.studies.machines import before as with_readings

Truths = dict[str, Estimate]

CORRECTIONS_STRIDE, MACHINES_STRIDE, INSULATORS_STRIDE = 25, 33, 35
"""Every so-many-th of the 450, 396 and 210 set-ups is taken."""
CLOSED_FORMS = 2
"""Random scenes of each closed form but the bowls, whose meshes are files of no fixed content."""
CLOSED, ACCURATE, REDUCED = "formula", "reduced:1e-2", "reduced+entries:1e-2"
ELEMENTS = "boundary-elements:1e-2"
PAIRS, FINE_ELEMENTS = "formula of pairs", "boundary-elements:1e-3"
_MOVING = Path(__file__).with_name("golden_moving.json")
_FINE: dict[str, Any] = {"method": asking.BOUNDARY_ELEMENTS, "rtol": 1e-3}
_OPTIONS = asking.METHODS | {PAIRS: asking.METHODS[CLOSED], FINE_ELEMENTS: _FINE}


@dataclass(frozen=True, eq=False)
class Case:
    """A scene that a method is asked for, and what is known of it (F); without readings it is asked for its Maxwell matrix or pairs. `question`
    is a hash of all that is asked."""

    name: str
    method: str
    text: str
    has_readings: bool
    options: dict[str, Any]
    truths: Truths
    question: str


def all_cases() -> list[Case]:
    """Returns all cases."""
    topics = _corrections, _company, _machines, _insulators, _closed_forms, _moving
    return [case for topic in topics for case in topic()]


def _cases(
    name: str, scene: Scene, methods: Iterable[str], truths: Truths, has_readings: bool = True, **more: Any
) -> Iterator[Case]:
    yield from _asked(name, *canonical_and_identity(scene), methods, truths, has_readings, **more)


def _asked(
    name: str,
    text: str,
    identity: str,
    methods: Iterable[str],
    truths: Truths,
    has_readings: bool = True,
    **more: Any,
) -> Iterator[Case]:
    for method in methods:
        options = _OPTIONS[method] | more
        asked = json.dumps([identity, has_readings, options], default=np.ndarray.tolist)
        question = hashlib.sha256(asked.encode()).hexdigest()
        yield Case(f"{name}/{method}", method, text, has_readings, options, truths, question)


def _corrections() -> Iterator[Case]:
    """A sensor and a target alone: the matrix, the formula's pair, and the change of the sensor's own capacitance, which is a difference."""
    known = corrections.load()
    for set_up in list(corrections.set_ups(model_module()))[::CORRECTIONS_STRIDE]:
        true, name = known[set_up.identity], f"corrections/{set_up.name}"
        change = Estimate(true.sensor - true.sensor_alone, corrections.RTOL * true.sensor)
        truths = {
            asking.entry("sensor", "target"): Estimate(-true.mutual, true.error),
            asking.pair("sensor", "target"): Estimate(true.mutual, true.error),
        }
        yield from _cases(name, set_up.scene, (PAIRS, REDUCED, FINE_ELEMENTS), truths, has_readings=False)
        marked = with_readings(set_up.scene, ())
        yield from _cases(name, marked, (CLOSED, ACCURATE), {part_of("sensor", CHANGE): change})


def _company() -> Iterator[Case]:
    """The set-ups whose readings are stored by the field solver."""
    checks = company.CHECK.records()
    for set_up in (each for each in company.all_set_ups() if each.identity in checks):
        true, name = checks[set_up.identity], f"company/{set_up.machine} {set_up.number}, {set_up.ground}"
        truths = {part_of(company.SENSOR, part): Estimate(**true[part]) for part in asking.PARTS}
        yield from _cases(name, set_up.scene, (CLOSED, ACCURATE, REDUCED, FINE_ELEMENTS), truths)


def _machines() -> Iterator[Case]:
    known = machines_truths.load()
    for set_up in machines.all_set_ups()[::MACHINES_STRIDE]:
        truths = {part_of(machines.READING, CHANGE): known[set_up.identity].changes.full}
        name = f"machines/{set_up.name}"
        yield from _cases(name, set_up.scene, (CLOSED, ACCURATE, REDUCED, ELEMENTS), truths)


def _insulators() -> Iterator[Case]:
    known = insulators.load()
    for set_up in insulators.all_set_ups()[::INSULATORS_STRIDE]:
        true = known[set_up.identity].insulated
        truths = {part_of(insulators.READING, part): getattr(true, part) for part in ("background", CHANGE)}
        name = f"insulators/{set_up.name}"
        yield from _cases(name, set_up.scene, (CLOSED, REDUCED, ELEMENTS), truths)


def _closed_forms() -> Iterator[Case]:
    """Random scenes of fixed seeds whose answers are known in closed form."""
    forms = [form for form in dict.fromkeys(closed_forms.FORMS) if form is not closed_forms.bowls]
    for form, seed in itertools.product(forms, range(CLOSED_FORMS)):
        known = form(random.Random(seed), Path())
        is_read = asking.has_readings(known.scene)
        methods = (CLOSED, ACCURATE, REDUCED, ELEMENTS) if is_read else (REDUCED, ELEMENTS)
        name = f"closed forms/{form.__name__} {seed}"
        yield from _cases(name, known.scene, methods, known.truths, is_read)


def _moving() -> Iterator[Case]:
    """Machines in poses of their motions with stored truths, all poses at once."""
    document = read_json(_MOVING)
    assert document is not None
    for name, machine in document["machines"].items():
        text, poses = machine["scene"], machine["poses"]
        truths = {
            part_of(asking.in_pose(reading, number), CHANGE): Estimate(*known)
            for number, pose in enumerate(poses)
            for reading, known in pose["changes"].items()
        }
        motion = np.array([pose["links"] for pose in poses])
        identity = hashlib.sha256(text.encode()).hexdigest()
        yield from _asked(f"moving/{name}", text, identity, (CLOSED, ACCURATE), truths, motion=motion)


MOST_WIDER, MOST_SLOWER = 1.1, 1.1
"""Largest ratio of a new stated error to the old one, and of the new times of a method to the old ones."""
_ROUNDING = 1e-9
"""What another order of operations may alter, relative to the value: the bound on what states no error."""
_MOST_MOVED = 20
_HEADER = (
    "method", "cases", "quantities", "moved", "by % at most", "by errors", "stated ratio", "truths held, old", "new", "of", "time ratio",
)  # fmt: skip


@dataclass(frozen=True)
class Recorded:
    """A case of a golden file: its answer, whose key stands for what was asked, and what is known of it (F)."""

    method: str
    answer: Answer
    truths: dict[str, Estimate]

    @property
    def held(self) -> int:
        """How many truths lie within the stated error, their own allowed for."""
        return sum(
            each.error is not None and Estimate(each.value, each.error).agrees_with(self.truths[name])
            for name, each in self.answer.values.items()
            if name in self.truths and each.value is not None
        )


@dataclass
class Row:
    """What became of a method's cases. The largest move is given relative to the value and to both stated errors, which may be wide; `held` and
    `seconds` are of the old file and the new."""

    cases: int = 0
    quantities: int = 0
    moved: int = 0
    largest_part: float = 0.0
    largest_move: float = 0.0
    largest_stated: float = 0.0
    truths: int = 0
    held: list[int] = field(default_factory=lambda: [0, 0])
    seconds: list[float] = field(default_factory=lambda: [0.0, 0.0])

    @property
    def time_ratio(self) -> float:
        return self.seconds[1] / self.seconds[0] if self.seconds[0] > 0 else 1.0

    @property
    def cells(self) -> tuple[object, ...]:
        sizes = f"{100 * self.largest_part:.2g}", f"{self.largest_move:.2g}", f"{self.largest_stated:.3g}"
        counts = self.cases, self.quantities, self.moved
        return (*counts, *sizes, *self.held, self.truths, f"{self.time_ratio:.2f}")


@dataclass
class Comparison:
    """Rows by their methods; `moved` has the size of a move and its line, `faults` are what the gate does not let through."""

    rows: dict[str, Row] = field(default_factory=dict)
    moved: list[tuple[float, str]] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    @property
    def text(self) -> str:
        """The table, the largest moves, warnings, faults and the verdict."""
        lines = markdown_table(_HEADER, [(name, *row.cells) for name, row in self.rows.items()])
        if self.moved:
            lines += ["", f"Moved: {len(self.moved)} quantities; the largest moves, in pF:"]
            lines += [f"* {line}" for _, line in sorted(self.moved, reverse=True)[:_MOST_MOVED]]
        lines += [f"warning: {line}" for line in self.warnings]
        lines += [f"fault: {line}" for line in self.faults]
        verdict = f"fails, faults: {len(self.faults)}" if self.faults else "passes"
        return "\n".join([*lines, f"The gate {verdict}."]) + "\n"


def compared(old: dict[str, Recorded], new: dict[str, Recorded], with_times: bool) -> Comparison:
    """Compares the same cases of two files; more time is a fault, not only a warning, with `with_times`."""
    found = Comparison()
    for name, after in new.items():
        was, now = old[name].answer, after.answer
        row = found.rows.setdefault(after.method, Row())
        row.cases += 1
        row.truths += len(after.truths.keys() & now.values.keys())
        row.held = [row.held[0] + old[name].held, row.held[1] + after.held]
        if was.outcome == asking.ANSWERED and now.outcome != asking.ANSWERED:
            found.faults.append(f"{name}: was answered, is {now.outcome}{now.reason and f': {now.reason}'}")
        elif was.outcome == asking.ANSWERED:
            row.seconds = [row.seconds[0] + was.seconds, row.seconds[1] + now.seconds]
            for quantity, stated in was.values.items():
                _compare(found, row, f"{name}: {quantity}", stated, now.values.get(quantity))
        if was.reached and not now.reached:
            found.faults.append(f"{name}: no longer reaches what was asked")
    for method, row in found.rows.items():
        before, now_held = row.held
        if now_held < before:
            found.faults.append(f"{method}: {now_held} truths within the stated error, {before} before")
        if row.time_ratio > MOST_SLOWER:
            slow = found.faults if with_times else found.warnings
            slow.append(f"{method}: takes {row.time_ratio:.2f} times the time")
    return found


def _compare(found: Comparison, row: Row, name: str, was: Stated, now: Stated | None) -> None:
    """Adds what became of one quantity."""
    row.quantities += 1
    if was.value is None:
        return
    if now is None or now.value is None:
        found.faults.append(f"{name}: has no value any more")
        return
    rounding = _ROUNDING * abs(was.value)
    difference, allowed = abs(now.value - was.value), (was.error or 0.0) + (now.error or 0.0)
    move = difference / allowed if allowed > 0 else math.inf if difference > rounding else 0.0
    old, new = (picofarads(*each) for each in ((was.value, was.error or 0.0), (now.value, now.error or 0.0)))
    line = f"{name}: {old} → {new}"
    if difference > 0:
        row.moved += 1
        row.largest_part = max(row.largest_part, difference / max(abs(was.value), abs(now.value)))
        row.largest_move = max(row.largest_move, move)
        found.moved.append((move, f"{line}, {move:.2g} of both errors"))
    if difference > allowed + rounding:
        found.faults.append(f"{line}: farther than both errors")
    if was.error is not None and now.error is None:
        found.faults.append(f"{line}: states no error any more")
    elif was.error and now.error is not None:
        row.largest_stated = max(row.largest_stated, now.error / was.error)
        if now.error > MOST_WIDER * was.error + rounding:
            found.faults.append(f"{line}: states more than {MOST_WIDER:g} times the error")


_FORMAT = 1
_SECONDS = 120.0
"""Most processor time for an answer: far more than any case takes."""
_ENOUGH, _MOST_ASKED = 0.25, 5
"""Seconds after which a case is not asked again for a smaller time, and how often it is asked at most."""


def run(file: Path, against: Path | None, only: str, with_times: bool) -> Comparison | None:
    """Asks the cases whose names hold the pattern `only`, writes the file, whole or not at all, and returns the comparison with an older
    one if there is one; InputError for what cannot be used, before anything is asked."""
    old = {name: each for name, each in load(against).items() if _matches(name, only)} if against else None
    chosen = [each for each in all_cases() if _matches(each.name, only)]
    if not chosen:
        raise InputError("", "--only", f"no case's name holds {only!r}")
    if old is not None:
        questions = {name: each.answer.key for name, each in old.items()}
        asked = {case.name: case.question for case in chosen}
        if other := sorted(name for name, _ in questions.items() ^ asked.items()):
            raise InputError(str(against), other[0], "the golden file has other cases than are asked now")
    new = recorded(chosen)
    document = {"format": _FORMAT, "cases": {name: asdict(each) for name, each in new.items()}}
    try:
        write_json(file, document)
    except OSError as error:
        raise InputError(str(file), "", error.strerror or str(error)) from error
    return None if old is None else compared(old, new, with_times)


def load(file: Path) -> dict[str, Recorded]:
    """Returns the cases of a golden file by their names; InputError for any other file."""
    document = read_json(file)
    try:
        if document is None or document["format"] != _FORMAT:
            raise ValueError
        return {
            name: Recorded(each["method"], judging.answer(each["answer"]), judging.estimates(each["truths"]))
            for name, each in document["cases"].items()
        }
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        reason = "is no golden file, as python3 -m analysis golden writes it"
        raise InputError(str(file), "", reason) from error


def recorded(chosen: Sequence[Case]) -> dict[str, Recorded]:
    """Asks all cases, one at a time, each in all threads that the library takes; a bar shows the progress."""
    found: dict[str, Recorded] = {}
    with Worker() as worker:
        run_all([_Job(case, worker, found) for case in chosen], 1, "cases")
    return {case.name: found[case.name] for case in chosen}


@dataclass(frozen=True)
class _Job:
    """The job of asking one case, repeated where the answer takes milliseconds; the smallest time counts."""

    case: Case
    worker: Worker
    found: dict[str, Recorded]
    seconds: float = 1.0

    def run(self, processes: Processes) -> Failure | None:
        case = self.case
        answers: list[Answer] = []
        while not answers or (len(answers) < _MOST_ASKED and sum(each.seconds for each in answers) < _ENOUGH):
            asked = case.text, case.has_readings, case.options, _SECONDS
            answers.append(self.worker.ask(*asked, processes.refuse_to_go_on))
        fastest = min(each.seconds for each in answers)
        answer = replace(answers[0], seconds=fastest, key=case.question)
        self.found[case.name] = Recorded(case.method, answer, case.truths)
        return None


def _matches(name: str, pattern: str) -> bool:
    return fnmatch.fnmatchcase(name, f"*{pattern}*")
