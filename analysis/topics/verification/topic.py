"""The verification of the field reference as a topic: known capacitances, its errors and its orders of convergence."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from markupsafe import Markup

from analysis.pipeline import keys
from analysis.pipeline.processes import Processes
from analysis.pipeline.scheduler import parallel_jobs, run_all
from analysis.pipeline.stage import NoAnswer, Stage, outdated, parsed
from analysis.results.store import Document, read_json
from analysis.results.study_results import Failure
from analysis.topics.topic import Topic
from analysis.topics.verification import section
from geometries.common.installation import ROOT

_SOURCES = ("truths.py", "boundary_elements.json", "rooms.json", "set_ups.py", "rows.py")
# Expected seconds of a row on one core, for the order and the progress bar.
_SECONDS, _SECONDS_OF_STRIPS = 8.0, 30.0
_COMPILES_FORMS = "cube"


@dataclass(frozen=True)
class Row:
    """A row by its name."""

    id: str


def all_rows() -> Iterator[Row]:
    """Gives all rows in their order."""
    # Imported when the first one is asked for: loading the solver takes a second, and a report that is up to date does not need it.
    from analysis.topics.verification import set_ups

    yield from map(Row, set_ups.true_cases())


def code(repository: Path = ROOT) -> str:
    """Returns the version of the code that computes rows: the reference, and the set-ups and comparisons of this package."""
    own = keys.hash_of_files(
        [repository / "analysis" / "topics" / "verification" / name for name in _SOURCES], repository
    )
    return f"{keys.reference_code(repository)} {own}"


def key(name: str, code: str) -> str:
    """Returns the key of a row."""
    return keys.measurement_key(name, code, {})


def path_of(folder: Path, name: str) -> Path:
    return folder / "rows" / f"{name.replace('/', '-').replace(' ', '_')}.json"


@dataclass(frozen=True)
class Rows:
    """The stages of all rows."""

    name: str = "verification"

    def run(self, folder: Path, rows: Iterable[Row], workers: int | None = None) -> list[Failure]:
        """Solves the rows that are missing or out of date, `workers` at a time; returns those that failed."""
        current = code()
        missing = outdated([stage(folder, row.id, current) for row in rows])
        failures: list[Failure] = []
        # The others would wait for the forms that the first solve compiles.
        first = [each for each in missing if each.name == _COMPILES_FORMS]
        rest = [each for each in missing if each not in first]
        for group in (first, rest):
            failures += run_all(group, workers or parallel_jobs(), "rows of the verification")
        return failures

    def load(self, folder: Path, _: Iterable[Row]) -> dict[str, Document]:
        """Returns the rows in a folder that are up to date, by name; rows of another version of the code are left out."""
        stored = [read_json(path) for path in sorted((folder / "rows").glob("*.json"))]
        current = code() if stored else ""
        return {
            row["row"]: row for row in stored if row is not None and row["key"] == key(row["row"], current)
        }


def stage(folder: Path, name: str, code: str) -> Stage:
    """Returns the stage of one row."""
    seconds = _SECONDS_OF_STRIPS if name.startswith("facing strips") else _SECONDS
    return Stage(name, "", path_of(folder, name), key(name, code), seconds, functools.partial(answer, name))


def answer(name: str, processes: Processes) -> Document:
    """Solves one row."""
    finished = processes.run_module("analysis.topics.verification.rows", name)
    if finished.exit_code != 0:
        raise NoAnswer(finished.reason)
    return {"row": name, **parsed(finished.output)}


Entry = tuple[str, Document]
"""The name of a row and its answer."""


def truths(found: list[Entry]) -> Markup:
    """Returns the chapter on known capacitances; one sentence without rows."""
    rows = dict(found)
    missing = [row.id for row in all_rows() if row.id not in rows] if rows else []
    return section.chapter(section.compared(rows), missing)


def _finding(found: list[Entry]) -> str:
    compared = section.compared(dict(found))
    return section.finding(compared) if compared else section.ABSENT


VERIFICATION = Topic[Row, Entry](
    stages=Rows(),
    set_ups=all_rows,
    entry=lambda row, answer: (row.id, answer),
    sections=lambda found, _, __: [truths(found)],
    finding=_finding,
    absent=section.ABSENT,
    title="Is the field solver right, and are its stated errors?",
    command="verify",
)
