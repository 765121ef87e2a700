"""Measures run time against error; the answer is kept as long as code, set-ups and machine are the same."""

from __future__ import annotations

import functools
from pathlib import Path

from analysis.pipeline import keys
from analysis.pipeline.processes import Processes
from analysis.pipeline.scheduler import run_all
from analysis.pipeline.stage import NoAnswer, Stage, outdated, unfinished_file
from analysis.results import machine
from analysis.results.store import Document, read_json
from analysis.results.study_results import Failure
from geometries.common.installation import ROOT, from_repository

ANSWER = "trade_off.json"
NAME = "run time against error of all methods"
_MODULE = "analysis.topics.trade_off.measure"
_SOURCES = ("model", "CMakeLists.txt", "CMakePresets.json", "analysis/topics/trade_off/measure.py")
_SECONDS = 90.0


def run(folder: Path, cases: list[str], wanted: bool) -> list[Failure]:
    """Measures the cases of a study whose manifest is in the folder, if `wanted` and not done; an outdated answer is removed."""
    target = folder / ANSWER
    stages = outdated(
        [Stage(NAME, "", target, key(cases), _SECONDS, functools.partial(_answer, folder, target))]
    )
    return run_all(stages, 1, "measured") if wanted else []


def load(folder: Path) -> Document | None:
    """Returns the answer in a folder of results; None without one."""
    return read_json(folder / ANSWER)


def command(folder: Path) -> str:
    """Returns the command, from the project's folder, that repeats the measurement."""
    return f"python3 -m {_MODULE} {from_repository(folder)} again.json"


def key(cases: list[str]) -> str:
    """Returns the key, which depends on the machine because times do; `cases` are the identities of the set-ups."""
    return keys.measurement_key(
        f"{_MODULE} {' '.join(cases)}", keys.code_of(_SOURCES, ROOT), machine.identity()
    )


def _answer(folder: Path, target: Path, processes: Processes) -> Document:
    with unfinished_file(target) as unfinished:
        finished = processes.run_module(_MODULE, str(folder.resolve()), str(unfinished))
        answer = read_json(unfinished)
    if finished.exit_code != 0 or answer is None:
        raise NoAnswer(finished.reason)
    return {**machine.origin(), **answer}
