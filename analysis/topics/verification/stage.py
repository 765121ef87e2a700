"""Solves the rows of the verification, each in a process of its own; finished rows are not solved again."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from analysis.pipeline import keys
from analysis.pipeline.processes import Processes
from analysis.pipeline.scheduler import parallel_jobs, run_all
from analysis.pipeline.stage import NoAnswer, Stage, outdated, parsed
from analysis.results import machine
from analysis.results.store import Document, read_json
from analysis.results.study_results import Failure
from geometries.common.installation import ROOT

_SOURCES = (
    "truths.py",
    "truths_of_revolution.py",
    "boundary_elements.json",
    "rooms.json",
    "set_ups.py",
    "rows.py",
)
# Expected seconds of a row on one core, for the order and the progress bar.
_SECONDS = {"truth": 8.0, "cost": 12.0}
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


@dataclass(frozen=True)
class Row:
    """A row by its name."""

    id: str


def all_rows() -> Iterator[Row]:
    """Gives all rows in their order."""
    # Imported when the first one is asked for: loading the solver takes a second, and a report that is up to date does not need it.
    from analysis.topics.verification import rows

    yield from map(Row, rows.row_names())


def code(repository: Path = ROOT) -> str:
    """Returns the version of the code that computes rows: the reference, and the set-ups and comparisons of this package."""
    own = keys.hash_of_files(
        [repository / "analysis" / "topics" / "verification" / name for name in _SOURCES], repository
    )
    return f"{keys.reference_code(repository)} {own}"


def key(name: str, code: str) -> str:
    """Returns the key of a row; that of run times depends on the machine, too."""
    return keys.measurement_key(name, code, machine.identity() if name.startswith("cost/") else {})


def path_of(folder: Path, name: str) -> Path:
    return folder / "rows" / f"{name.replace('/', '-').replace(' ', '_')}.json"


@dataclass(frozen=True)
class Rows:
    """The stages of all rows."""

    name: str = "verification"

    def run(self, folder: Path, rows: Iterable[Row], workers: int | None = None) -> list[Failure]:
        """Solves the rows that are missing or out of date; returns those that failed.

        Truths come first, then the rows whose run times are measured, `workers` at a time.
        """
        current = code()
        missing = outdated([stage(folder, row.id, current) for row in rows])
        failures: list[Failure] = []
        # The others would wait for the forms that the first solve compiles.
        first = [each for each in missing if each.name == _COMPILES_FORMS]
        timed = [each for each in missing if each.name.startswith("cost/")]
        rest = [each for each in missing if each not in first + timed]
        for group in (first, rest, timed):
            failures += run_all(group, workers or parallel_jobs(), "rows of the verification")
        return failures

    def load(self, folder: Path, _: Iterable[Row]) -> dict[str, Document]:
        """Returns the rows in a folder that are up to date, by name; rows of another version of the code or machine are left out."""
        stored = [read_json(path) for path in sorted((folder / "rows").glob("*.json"))]
        current = code() if stored else ""
        return {
            row["row"]: row for row in stored if row is not None and row["key"] == key(row["row"], current)
        }


def stage(folder: Path, name: str, code: str) -> Stage:
    """Returns the stage of one row."""
    seconds = _LONG.get(name, _SECONDS[name.partition("/")[0]])
    return Stage(name, "", path_of(folder, name), key(name, code), seconds, functools.partial(answer, name))


def answer(name: str, processes: Processes) -> Document:
    """Solves one row."""
    finished = processes.run_module("analysis.topics.verification.rows", name)
    if finished.exit_code != 0:
        raise NoAnswer(finished.reason)
    return {"row": name, **parsed(finished.output)}
