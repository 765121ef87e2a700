"""The rows of the verification, each solved in a process of its own and kept under its key: finished rows are not solved again."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

from analysis.pipeline import keys
from analysis.pipeline.jobs import Job, parallel_jobs, run_all
from analysis.pipeline.keys import REPOSITORY
from analysis.pipeline.processes import Processes
from analysis.pipeline.reference_stage import forget_unfinished_forms
from analysis.results import machine
from analysis.results.store import Document, read_current, read_json, write_json
from analysis.results.study_results import Failure
from geometries.common.installation import cache_folder

FOLDER = "verification"
"""Of the rows, beside the folders of the studies' results."""
_SOURCES = (
    "truths.py",
    "truths_of_revolution.py",
    "boundary_elements.json",
    "set_ups.py",
    "properties.py",
    "rows.py",
    "uniform_meshes.py",
)
# What a row takes on one core, roughly: only for the order and the progress bar.
_SECONDS = {"truth": 8.0, "property": 6.0, "cost": 12.0}
_LONG = {
    "truth/facing strips, width/gap 1": 30.0,
    "truth/facing strips, width/gap 5": 30.0,
    "cost/close/estimate": 60.0,
    "cost/close/enclosure": 60.0,
    "cost/hinge/estimate": 40.0,
    "cost/parallel/tight": 40.0,
    "cost/tilted/tight": 40.0,
}
_COMPILES_FORMS = "truth/cube"
_SAID_AT_MOST = 300


def row_names() -> list[str]:
    """Every row there is."""
    # Imported here: the solver takes a second, and a report that is up to date needs none.
    from analysis.topics.verification import rows

    return rows.row_names()


def code(repository: Path = REPOSITORY) -> str:
    """The version of what rows are computed by: the reference, and the set-ups and comparisons of this package."""
    own = keys.hash_of_files(
        [repository / "analysis" / "topics" / "verification" / name for name in _SOURCES], repository
    )
    return f"{keys.reference_code(repository)} {own}"


def key(name: str, code: str) -> str:
    """The key of a row; run times belong to a machine as well."""
    return keys.measurement_key(name, code, machine.identity() if name.startswith("cost/") else {})


def path_of(folder: Path, name: str) -> Path:
    return folder / "rows" / f"{name.replace('/', '-').replace(' ', '_')}.json"


def run(folder: Path, names: list[str], workers: int | None = None) -> list[Failure]:
    """Solve the rows that are missing or out of date; returns those that failed.

    Truths and properties first, as many at a time as cores; then the run times, as many at a time again.
    """
    current = code()
    missing = [name for name in names if read_current(path_of(folder, name), key(name, current)) is None]
    for name in missing:
        path_of(folder, name).unlink(missing_ok=True)
    failures: list[Failure] = []
    try:
        # What the first solve compiles, the others would wait for.
        first = [name for name in missing if name == _COMPILES_FORMS]
        timed = [name for name in missing if name.startswith("cost/")]
        rest = [name for name in missing if name not in first + timed]
        for group in (first, rest, timed):
            if group:
                jobs = [_job(name, path_of(folder, name), key(name, current)) for name in group]
                failures += run_all(jobs, workers or parallel_jobs(), "rows of the verification")
    except BaseException:
        forget_unfinished_forms()
        raise
    return failures


def load(folder: Path) -> dict[str, Document]:
    """The rows in a folder that are up to date, by name; a row of another version of the code or machine is none."""
    stored = [read_json(path) for path in sorted((folder / "rows").glob("*.json"))]
    current = code() if stored else ""
    return {row["row"]: row for row in stored if row is not None and row["key"] == key(row["row"], current)}


def solve(name: str, target: Path, key: str, processes: Processes) -> Failure | None:
    """Solve one row and store it with its key; returns why, when there is none."""
    environment = os.environ | {
        "OMP_NUM_THREADS": "1",
        "XDG_CACHE_HOME": str(cache_folder()),
        "PYTHONPATH": str(REPOSITORY),
    }
    finished = processes.run(
        [sys.executable, "-m", "analysis.topics.verification.rows", name], REPOSITORY, environment
    )
    if finished.exit_code != 0:
        told = (finished.errors.strip() or "no message").splitlines()[-1][:_SAID_AT_MOST]
        return Failure("", name, f"exit code {finished.exit_code}: {told}")
    try:
        document = json.loads(finished.output)
    except ValueError:
        return Failure("", name, "printed no JSON document")
    write_json(target, {"key": key, "row": name, **document})
    return None


def _job(name: str, target: Path, key: str) -> Job:
    seconds = _LONG.get(name, _SECONDS[name.partition("/")[0]])
    return Job(seconds, lambda processes: solve(name, target, key, processes))
