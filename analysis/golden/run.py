"""Asks all cases one after the other, writes the golden file, and compares it with an older one."""

from __future__ import annotations

import fnmatch
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from analysis.golden import cases, gate
from analysis.golden.cases import Case
from analysis.golden.gate import Comparison, Recorded
from analysis.honesty import judging
from analysis.honesty.asking import Worker
from analysis.honesty.methods import Answer
from analysis.pipeline.processes import Processes
from analysis.pipeline.scheduler import run_all
from analysis.results.answers import Estimate
from analysis.results.store import Document, read_json, write_json
from analysis.results.study_results import Failure
from geometries.common.errors import InputError

_FORMAT = 1
_SECONDS = 120.0
"""Most processor time for an answer: far more than any case takes."""
_ENOUGH, _MOST_ASKED = 0.25, 5
"""Seconds after which a case is not asked again for a smaller time, and how often it is asked at most."""


def run(
    file: Path, against: Path | None = None, only: str = "", with_times: bool = False
) -> Comparison | None:
    """Asks the cases whose names hold the pattern `only`, writes the file, whole or not at all, and returns the comparison with an older
    one if there is one; InputError for what cannot be used, before anything is asked."""
    old = {name: each for name, each in load(against).items() if _matches(name, only)} if against else None
    chosen = [each for each in cases.all_cases() if _matches(each.name, only)]
    if not chosen:
        raise InputError("", "--only", f"no case's name holds {only!r}")
    if old is not None:
        _check(str(against), old, chosen)
    new = recorded(chosen)
    document = {"format": _FORMAT, "cases": {name: asdict(each) for name, each in new.items()}}
    try:
        write_json(file, document)
    except OSError as error:
        raise InputError(str(file), "", error.strerror or str(error)) from error
    return None if old is None else gate.compared(old, new, with_times)


def load(file: Path) -> dict[str, Recorded]:
    """Returns the cases of a golden file by their names; InputError for any other file."""
    document = read_json(file)
    try:
        if document is None or document["format"] != _FORMAT:
            raise ValueError
        return {name: _recorded(each) for name, each in document["cases"].items()}
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(
            str(file), "", "is no golden file, as python3 -m analysis golden writes it"
        ) from error


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


def _check(file: str, old: dict[str, Recorded], chosen: Sequence[Case]) -> None:
    """Refuses a file whose cases are not those that are asked now."""
    questions = {name: each.answer.key for name, each in old.items()}
    other = sorted(
        name for name, _ in questions.items() ^ {case.name: case.question for case in chosen}.items()
    )
    if other:
        raise InputError(file, other[0], "the golden file has other cases than are asked now")


def _recorded(document: Document) -> Recorded:
    truths = {name: Estimate(**known) for name, known in document["truths"].items()}
    return Recorded(document["method"], judging.answer(document["answer"]), truths)
