"""The values of all nights of a study, what has changed in them, and which of it is an alarm. `trends.jsonl` beside the table has one line for each value, to which
nights only append; a value is not written again as long as its answer stays the stored one: the line would say nothing new.

A value has moved where two records that follow each other differ by more than both their errors. It drifts where the mean of its last four records and that of the first
four since it last moved differ by as much, however small each step was. The same is told of instruction counts; that fewer are needed is no alarm. Run times by the clock
are never looked at. On another machine, with another processor or other versions of packages, alarms are held back where most values of the same method moved at once: it
is the machine that they tell of."""

import csv
import json
import math
import subprocess
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace
from datetime import datetime, timezone
from pathlib import Path

from analysis.results import machine, study_results
from analysis.results.statistics import grouped
from analysis.results.store import finite, read_json
from analysis.results.study_results import Results, case_folder
from analysis.results.table import TABLE
from analysis.results.truth import BOUNDARY, FIELD
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
    """One value of one night. `kind` is the method, or INSTRUCTIONS, and `name` what the value is of; `case` is the case's id, empty
    for counts. Value and `error`, the half-width of its interval, are farads, or instructions; a value that is not finite is NaN.
    `command` computes the answer anew, from the project's folder, `inputs` is the key of the answer, and `versions` are those of the
    packages it depends on."""

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
    values = [math.nan if each["value"] is None else each["value"] for each in known]
    return [Record(**each | {"value": value}) for each, value in zip(known, values)]


def of_night(folder: Path) -> list[Record]:
    """Returns the values in a folder of results, with the commands, the inputs and the packages that each was computed by."""
    results = study_results.load(folder)
    files = {FIELD: study_results.REFERENCE, BOUNDARY: study_results.BOUNDARY}
    answers: dict[Path, tuple[str, str]] = {}
    known = []
    for each in of_table(folder):
        path = case_folder(folder, each.case) / files.get(each.kind, study_results.MODEL)
        if path not in answers:
            document = read_json(path) or {}
            packages = sorted(document.get("versions", {}).items())
            answers[path] = document.get("key", ""), ", ".join(" ".join(package) for package in packages)
        inputs, versions = answers[path]
        known.append(replace(each, command=_command(results, each), inputs=inputs, versions=versions))
    return known


def add(folder: Path, found: Iterable[Record], at: str | None = None) -> list[Record]:
    """Appends what is new of these values, as of the commit `at` or else the one that is checked out; returns it."""
    last = {each.series: (each.inputs, finite(each.value)) for each in load(folder)}
    now = {
        "time": datetime.now(timezone.utc).isoformat(timespec="microseconds"),
        "commit": at or commit(),
        "processor": machine.description()["processor"],
    }
    others = (each for each in found if last.get(each.series) != (each.inputs, finite(each.value)))
    new = [replace(each, **now) for each in others]
    lines = [json.dumps(asdict(each) | {"value": finite(each.value)}) + "\n" for each in new]
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / FILE).open("a+b") as file:
        # An unfinished line of a killed night goes: its values are written again now.
        file.seek(0)
        file.truncate(file.read().rfind(b"\n") + 1)
        file.write("".join(lines).encode())
    return new


def of_count(name: str, instructions: int, command: str, inputs: str, versions: str) -> Record:
    """Returns the record of an instruction count."""
    error = _COUNTING * instructions
    return Record(INSTRUCTIONS, name, "", instructions, error, None, command, inputs, versions)


def commit() -> str:
    """Returns the commit that is checked out, with the mark -dirty if files have changed since; `unknown` outside of a repository."""
    asked = ["git", "-C", str(ROOT), "describe", "--always", "--abbrev=40", "--dirty", "--exclude=*"]
    try:
        done = subprocess.run(ending_with_this(asked), capture_output=True, text=True, check=True)
        return done.stdout.strip()
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


def _command(results: Results, record: Record) -> str:
    references = {FIELD: study_results.reference_command, BOUNDARY: study_results.boundary_command}
    if record.kind in references:
        return f"{references[record.kind](results, record.case)} --json"
    return f"{study_results.model_command(results, record.case, record.kind.removeprefix(_MODEL))} --json"


MOVED, DRIFTED, SLOWER, FASTER = "moved", "drifted", "more instructions", "fewer instructions"
# Records whose mean a drift is told by, and the fewest values of a method that most of them can be told by.
_WINDOW, _FEWEST = 4, 3
_MOST_LINES = 20


@dataclass(frozen=True)
class Mark:
    """A change from one record to another; `over` is its size relative to what the errors of both allow. `held` tells whether most
    comparable values moved on another machine."""

    what: str
    before: Record
    after: Record
    over: float
    held: bool = False

    @property
    def is_alarm(self) -> bool:
        return not self.held and self.what != FASTER

    @property
    def relative(self) -> float:
        """The change over the value before; infinite where that was zero or not finite."""
        change = self.after.value - self.before.value
        return change / abs(self.before.value) if self.before.value else math.copysign(math.inf, change)


def marks(records: Iterable[Record]) -> list[Mark]:
    """Returns all changes, in the order of the nights, those of a night the largest first."""
    found: list[Mark] = []
    steps: dict[tuple[str, str], list[tuple[Record, Record]]] = defaultdict(list)
    for own in by_series(records).values():
        found += _of_series(own)
        for before, after in zip(own, own[1:]):
            if before.machine != after.machine:
                steps[after.kind, after.time].append((before, after))
    held = {
        night
        for night, comparable in steps.items()
        if len(comparable) >= _FEWEST and 2 * sum(_over(*step) > 1 for step in comparable) > len(comparable)
    }
    found.sort(key=lambda mark: (mark.after.time, -mark.over))

    def is_held(before: Record, after: Record) -> bool:
        return before.machine != after.machine and (after.kind, after.time) in held

    return [replace(mark, held=is_held(mark.before, mark.after)) for mark in found]


def by_series(records: Iterable[Record]) -> dict[tuple[str, str], list[Record]]:
    """Returns the records of each value, in the order given."""
    return grouped(records, lambda each: each.series)


def to_text(found: list[Mark]) -> str:
    """Writes alarms for people: a line that counts, and one for each of the largest."""
    alarms = [mark for mark in found if mark.is_alarm]
    held = sum(mark.held for mark in found)
    more_held = f"; {held} more on another machine, where most did" if held else ""
    lines = [f"{len(alarms)} values moved by more than their errors{more_held}"]
    for mark in alarms[:_MOST_LINES]:
        before, after = mark.before, mark.after
        lines.append(
            f"  {after.kind}: {after.name}: {mark.what}, {before.value:.7g} -> {after.value:.7g} ({mark.relative:+.2e}), "
            f"{mark.over:.3g} times what the errors allow"
        )
    more = [f"  … and {len(alarms) - _MOST_LINES} more"] if len(alarms) > _MOST_LINES else []
    return "\n".join(lines + more) + "\n"


def _of_series(own: list[Record]) -> list[Mark]:
    """Returns the changes of one value. After each, what was before counts no more."""
    found, since = [], own[:1]
    for before, after in zip(own, own[1:]):
        mark = None
        if (over := _over(before, after)) > 1:
            mark = _mark(MOVED, before, after, over)
        else:
            since.append(after)
            if len(since) >= 2 * _WINDOW:
                over = _over(_mean(since[:_WINDOW]), _mean(since[-_WINDOW:]))
                mark = _mark(DRIFTED, since[0], after, over) if over > 1 else None
        if mark is not None:
            found.append(mark)
            since = [after]
    return found


def _mark(what: str, before: Record, after: Record, over: float) -> Mark:
    if after.kind == INSTRUCTIONS:
        what = SLOWER if after.value > before.value else FASTER
    return Mark(what, before, after, over)


def _mean(some: list[Record]) -> Record:
    value, error = (sum(parts) / len(some) for parts in ([r.value for r in some], [r.error for r in some]))
    return replace(some[-1], value=value, error=error)


def _over(before: Record, after: Record) -> float:
    """Returns the change relative to both errors; 0 for equal values, also if neither is finite, and infinity if only one is."""
    if before.value == after.value or (math.isnan(before.value) and math.isnan(after.value)):
        return 0.0
    change, error = abs(after.value - before.value), before.error + after.error
    if not math.isfinite(change):
        return math.inf
    return change / error if error > 0 else math.inf
