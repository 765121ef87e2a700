"""The measurement of run time against error, kept with a study's results as long as code, set-ups and machine are the same."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from analysis.pipeline import keys
from analysis.pipeline.jobs import Job, run_all
from analysis.pipeline.keys import REPOSITORY
from analysis.pipeline.processes import Processes
from analysis.results import machine
from analysis.results.store import Document, is_current, read_json, write_json
from analysis.results.study_results import Failure
from geometries.common import installation

ANSWER = "trade_off.json"
NAME = "run time against error of all methods"
_MODULE = "analysis.topics.trade_off.measure"
_SOURCES = ("model", "CMakeLists.txt", "CMakePresets.json", "analysis/topics/trade_off/measure.py")
_SECONDS = 90.0


def run(folder: Path, cases: list[str], wanted: bool) -> list[Failure]:
    """Measure the cases of a study whose manifest is in the folder, if `wanted` and not done; what is out of date is removed."""
    target, key_ = folder / ANSWER, key(cases)
    if is_current(target, key_):
        return []
    target.unlink(missing_ok=True)
    if not wanted:
        return []
    return run_all(
        [Job(_SECONDS, lambda processes: _measure(folder, target, key_, processes))], 1, "measured"
    )


def load(folder: Path) -> Document | None:
    """The answer in a folder of results; None without one."""
    return read_json(folder / ANSWER)


def command(folder: Path) -> str:
    """The command, from the project's folder, that repeats the measurement."""
    return f"python3 -m {_MODULE} {installation.from_repository(folder)} again.json"


def key(cases: list[str]) -> str:
    """Times belong to a machine; `cases` are the identities of the set-ups."""
    return keys.measurement_key(
        f"{_MODULE} {' '.join(cases)}", keys.code_of(_SOURCES, REPOSITORY), machine.identity()
    )


def _measure(folder: Path, target: Path, key: str, processes: Processes) -> Failure | None:
    unfinished = target.with_name(f".{target.name}.unfinished").resolve()
    environment = os.environ | {
        "PYTHONPATH": os.pathsep.join(filter(None, [str(REPOSITORY), os.environ.get("PYTHONPATH", "")]))
    }
    try:
        finished = processes.run(
            [sys.executable, "-P", "-m", _MODULE, str(folder.resolve()), str(unfinished)],
            REPOSITORY,
            environment,
        )
        answer = read_json(unfinished)
    finally:
        unfinished.unlink(missing_ok=True)
    if finished.exit_code != 0 or answer is None:
        told = (finished.errors.strip() or "no message").splitlines()[-1]
        return Failure("", NAME, f"exit code {finished.exit_code}: {told}")
    origin = {
        "processor": machine.description()["processor"],
        "instruction_sets": machine.instruction_sets(),
    }
    write_json(target, {"key": key, **origin, **answer})
    return None
