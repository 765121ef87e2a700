"""The values of all nights of a study: `trends.jsonl` beside the table, one line for each value, to which nights only append.

A value is not written again as long as its answer stays the stored one: the line would say nothing new.
"""

from __future__ import annotations

import csv
import json
import math
import subprocess
from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace
from datetime import datetime, timezone
from pathlib import Path

from analysis.results import machine, study_results
from analysis.results.answers import BOUNDARY, FIELD
from analysis.results.store import read_json
from analysis.results.study_results import (
    Results,
    boundary_command,
    case_folder,
    model_command,
    reference_command,
)
from analysis.results.table import TABLE
from geometries.common.children import ending_with_this
from geometries.common.errors import InputError
from geometries.common.installation import ROOT

FILE = "trends.jsonl"
INSTRUCTIONS = "instructions"
"""The kind of the counts."""
_MODEL = "model "
# A value of the model and a count may change by twice this part of themselves: 1e5 times the rounding errors on any instruction
# set, and what a compiler changes by itself.
_ROUNDING, _COUNTING = 0.5e-9, 0.5e-2
_NAME = ("quantity", "sensor", "object", "reading")
_NEEDED = ("case", "family", "quantity", "sensor", "object")


@dataclass(frozen=True)
class Record:
    """One value of one night.

    `kind` is the method, or INSTRUCTIONS, and `name` what the value is of; `case` is the case's id, empty for counts. Value and
    `error`, the half-width of its interval, are farads, or instructions; a value that is not finite is NaN. `command` computes the
    answer anew, from the project's folder, `inputs` is the key of the answer, and `versions` are those of the packages it depends on.
    """

    kind: str
    name: str
    case: str
    value: float
    error: float
    seconds: float | None = None
    command: str = ""
    inputs: str = ""
    versions: str = ""
    processor: str = ""
    commit: str = ""
    time: str = ""

    @property
    def series(self) -> tuple[str, str]:
        """What the value is one of."""
        return self.kind, self.name

    @property
    def machine(self) -> tuple[str, str]:
        """What another machine is told by."""
        return self.processor, self.versions


def load(folder: Path) -> list[Record]:
    """Returns the values of all nights, the earliest first. A last line that a killed night left unfinished is passed over."""
    try:
        lines = (folder / FILE).read_text(encoding="utf-8").split("\n")[:-1]
    except FileNotFoundError:
        return []
    known = [json.loads(line) for line in lines]
    return [
        Record(**{**each, "value": math.nan if each["value"] is None else each["value"]}) for each in known
    ]


def of_night(folder: Path) -> list[Record]:
    """Returns the values in a folder of results, with what they were computed from."""
    return _with_origin(of_table(folder), study_results.load(folder))


def add(folder: Path, found: Iterable[Record], at: str | None = None) -> list[Record]:
    """Appends what is new of these values, as of the commit `at` or else the one that is checked out; returns it."""
    last = {each.series: (each.inputs, _finite(each.value)) for each in load(folder)}
    now = {
        "time": datetime.now(timezone.utc).isoformat(timespec="microseconds"),
        "commit": at or commit(),
        "processor": machine.description()["processor"],
    }
    new = [
        replace(each, **now) for each in found if last.get(each.series) != (each.inputs, _finite(each.value))
    ]
    lines = [json.dumps(asdict(each) | {"value": _finite(each.value)}) + "\n" for each in new]
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / FILE).open("a+b") as file:
        # An unfinished line of a killed night goes: its values are written again now.
        file.seek(0)
        file.truncate(file.read().rfind(b"\n") + 1)
        file.write("".join(lines).encode())
    return new


def of_count(name: str, instructions: int, command: str, inputs: str, versions: str) -> Record:
    """Returns the record of an instruction count."""
    return Record(
        INSTRUCTIONS, name, "", instructions, _COUNTING * instructions, None, command, inputs, versions
    )


def commit() -> str:
    """Returns the commit that is checked out, with the mark -dirty if files have changed since; `unknown` outside of a repository."""
    asked = ["git", "-C", str(ROOT), "describe", "--always", "--abbrev=40", "--dirty", "--exclude=*"]
    try:
        return subprocess.run(
            ending_with_this(asked), capture_output=True, text=True, check=True
        ).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def of_table(path: Path) -> list[Record]:
    """Returns the values in a table, or in the table of a folder of results; InputError when it cannot be used."""
    file = path / TABLE if path.is_dir() else path
    try:
        with file.open(encoding="utf-8", newline="") as opened:
            reader = csv.DictReader(opened)
            rows, columns = list(reader), reader.fieldnames or []
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(str(file), "", f"cannot be read: {error}") from error
    # A table without rows has no columns but one.
    if lacking := [name for name in _NEEDED if name not in columns] if rows or columns != ["case"] else []:
        raise InputError(str(file), lacking[0], "is missing from the columns of this table")
    found = []
    for number, row in enumerate(rows, start=2):
        try:
            found += _of_row(row)
        except (TypeError, ValueError) as error:
            raise InputError(str(file), f"line {number}", f"is not a row of a table: {error}") from error
    return found


def _of_row(row: dict[str, str]) -> list[Record]:
    what = " ".join(filter(None, (row.get(column) for column in _NAME)))
    name = f"{what}, {row['family']} {row['case']}"

    def of(kind: str, column: str, seconds: str, rounding: float = 0.0) -> Record:
        value, stated = float(row[f"{column}_F"]), float(row.get(f"{column}_error_F") or 0)
        needed = float(row[seconds]) if row.get(seconds) else None
        return Record(kind, name, row["case"], value, stated + rounding * abs(value), needed)

    methods = {FIELD: ("field", "field_seconds"), BOUNDARY: ("boundary", "")}
    found = [of(kind, *columns) for kind, columns in methods.items() if row.get(f"{columns[0]}_F")]
    for column in (column.removesuffix("_F") for column in row if column.startswith("model_")):
        if row.get(f"{column}_F") and not column.endswith("_error"):
            method = column.removeprefix("model_")
            found.append(of(_MODEL + method, column, f"{column}_seconds", _ROUNDING))
    return found


def _with_origin(found: list[Record], results: Results) -> list[Record]:
    """Adds by which command, from which inputs and with which packages each value was computed."""
    files = {FIELD: study_results.REFERENCE, BOUNDARY: study_results.BOUNDARY}
    answers: dict[Path, tuple[str, str]] = {}
    known = []
    for each in found:
        path = case_folder(results.folder, each.case) / files.get(each.kind, study_results.MODEL)
        if path not in answers:
            document = read_json(path) or {}
            packages = sorted(document.get("versions", {}).items())
            answers[path] = document.get("key", ""), ", ".join(" ".join(package) for package in packages)
        inputs, versions = answers[path]
        known.append(replace(each, command=_command(results, each), inputs=inputs, versions=versions))
    return known


def _command(results: Results, record: Record) -> str:
    if record.kind == FIELD:
        return f"{reference_command(results, record.case)} --json"
    if record.kind == BOUNDARY:
        return f"{boundary_command(results, record.case)} --json"
    return f"{model_command(results, record.case, record.kind.removeprefix(_MODEL))} --json"


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
