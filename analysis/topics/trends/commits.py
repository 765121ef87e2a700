"""Looks back at commits, each built in a working tree of its own: which one has changed a value, and how many instructions fixed workloads took at each.

Instructions are counted by callgrind: the same on a busy machine as on an idle one. Valgrind 3.19 emulates a processor with AVX2 and without AVX-512, so that the
counts are those of the AVX2 code whatever the machine; a machine without AVX2 counts other instructions."""

import hashlib
import json
import re
import shlex
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from analysis.topics.trends import changes
from geometries.common.children import ending_with_this, run_with_all_it_starts, temporary_folder
from geometries.common.errors import InputError
from geometries.common.installation import ROOT, from_repository, model_program

PROGRAM = model_program().with_name("instruction_counts")
# The function of the program that does the work and nothing else.
_WORKLOAD = "fringe::benchmarks::counted_workload*"
_COLLECTED = re.compile(r"Collected : (\d+)$", re.MULTILINE)
# Longest wait (s) for a workload, which takes seconds.
_LONGEST = 600.0


class CountingFailed(Exception):
    """The program or callgrind did not do what it should; the message says what it printed."""


def of_build(program: Path = PROGRAM) -> list[changes.Record]:
    """Returns the counts of a program; none without it or without valgrind. CountingFailed if one of them cannot be counted."""
    if not (program.is_file() and shutil.which("valgrind")):
        return []
    inputs = hashlib.sha256(program.read_bytes()).hexdigest()
    version = _run(["valgrind", "--version"]).strip()
    again = from_repository(PROGRAM)
    return [
        changes.of_count(name, count(name, program), shlex.join(_command(name, again)), inputs, version)
        for name in workloads(program)
    ]


def workloads(program: Path = PROGRAM) -> list[str]:
    """Returns the names of the program's workloads."""
    return _run([str(program), "--list"]).split()


def count(workload: str, program: Path = PROGRAM) -> int:
    """Returns the instructions of one workload, without its preparation; CountingFailed when there is no such count."""
    found = _COLLECTED.search(_run(_command(workload, str(program))))
    # Without the function's name in the program callgrind would count nothing, and nothing would ever be slow.
    if found is None or int(found[1]) == 0:
        raise CountingFailed(f"{workload}: callgrind counted nothing")
    return int(found[1])


def _command(workload: str, program: str) -> list[str]:
    """Returns the command that prints the count among other things, all on standard output."""
    counted = ["--collect-atstart=no", f"--toggle-collect={_WORKLOAD}", "--callgrind-out-file=/dev/null"]
    return ["valgrind", "--tool=callgrind", "--log-fd=1", *counted, program, workload]


def _run(command: list[str]) -> str:
    """Returns the command's standard output; CountingFailed when it is missing, fails, or takes too long."""
    asked = ending_with_this(command)
    try:
        finished = subprocess.run(asked, capture_output=True, text=True, check=False, timeout=_LONGEST)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise CountingFailed(str(error)) from error
    if finished.returncode != 0:
        reason = f"exit code {finished.returncode}: {finished.stderr.strip()}"
        raise CountingFailed(f"{' '.join(command)}: {reason}")
    return finished.stdout


_COUNTED = "instruction_counts"
BUILD = f"cmake --preset release && cmake --build build --target product {_COUNTED}"
BUILD_COUNTED = f"cmake --preset release && cmake --build build --target {_COUNTED}"
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
_DIRTY = "-dirty"


def count_each(
    folder: Path, commits: str, repository: Path = ROOT, build: str = BUILD_COUNTED
) -> Iterator[tuple[str, list[changes.Record]]]:
    """Counts the workloads at each of the commits, as `git rev-list` takes them, the earliest first, and adds the counts to the trends;
    yields each commit with what was new. Commits that cannot be built have no counts."""
    listed = _git(repository, "rev-list", "--first-parent", "--reverse", *commits.split()).split()
    if not listed:
        raise InputError(commits, "", "names no commits")
    with _tree(repository, listed[0]) as tree:
        for commit in listed:
            _git(tree, "checkout", "--detach", commit)
            built = _said(build, tree) is not None
            found = of_build(tree / "build" / "bin" / _COUNTED) if built else []
            yield commit, changes.add(folder, found, commit)


def find(folder: Path, name: str, repository: Path = ROOT, build: str = BUILD) -> str:
    """Returns what git says of the first commit after which the value was nearer to what it is since its last change than to what it
    was before; InputError if there is no such change, or its commits are not known. `name` is the value's, or `KIND: NAME` if
    several methods have one of that name. Commits that cannot be built are passed over."""
    mark = _last(folder, name)
    good, bad = (each.commit.removesuffix(_DIRTY) for each in (mark.before, mark.after))
    with _tree(repository, good) as tree:
        # The commands name scenes in the folder of results, which git does not have.
        (tree / "results").symlink_to(repository / "results")
        where = _nearest(_numbers(tree, mark, build) or {}, mark.before.value, name)
        said = _git(tree, "bisect", "start", bad, good)
        while "is the first bad commit" not in said and "only 'skip'ped commits left" not in said:
            said = _git(tree, "bisect", _word(_numbers(tree, mark, build), where, mark), wrong_is_said=True)
        return said


@contextmanager
def _tree(repository: Path, commit: str) -> Iterator[Path]:
    """Gives a working tree in which a commit is checked out."""
    with temporary_folder() as place:
        tree = place / "tree"
        _git(repository, "worktree", "add", "--detach", str(tree), commit)
        try:
            yield tree
        finally:
            _git(repository, "worktree", "remove", "--force", str(tree))


def _last(folder: Path, name: str) -> changes.Mark:
    marks = changes.marks(changes.load(folder))
    known = [mark for mark in marks if name in (mark.after.name, ": ".join(mark.after.series))]
    if not known:
        raise InputError(name, "", "is no value that has changed")
    before, after = known[-1].before, known[-1].after
    if before.commit == after.commit or "unknown" in (before.commit, after.commit):
        raise InputError(name, "", "has not changed between two commits that are known")
    return known[-1]


def _numbers(tree: Path, mark: changes.Mark, build: str) -> dict[str, float] | None:
    """Returns the numbers that the value's command prints there, by their places; None where it cannot be built or fails."""
    said = _said(mark.after.command, tree) if _said(build, tree) is not None else None
    if said is None:
        return None
    try:
        return dict(_flat(json.loads(said), ""))
    except ValueError:
        return {str(place): float(found) for place, found in enumerate(_NUMBER.findall(said))}


def _said(command: str, tree: Path) -> str | None:
    """Returns what a command prints there; None if it fails."""
    done = run_with_all_it_starts(command, tree)
    # Status 3 is that of an answer short of the accuracy asked for.
    return done.stdout if done.returncode in (0, 3) else None


def _flat(document: Any, place: str) -> Iterator[tuple[str, float]]:
    if isinstance(document, dict | list):
        parts = document.items() if isinstance(document, dict) else enumerate(document)
        for key, part in parts:
            yield from _flat(part, f"{place}/{key}")
    elif isinstance(document, int | float):
        yield place, float(document)


def _nearest(numbers: dict[str, float], value: float, name: str) -> str:
    """Returns the place of the number that the value was read from. Its sign may be another: mutual is minus an entry of a matrix."""
    if not numbers:
        raise InputError(name, "", "cannot be computed at the commit before its change")
    return min(numbers, key=lambda place: abs(abs(numbers[place]) - abs(value)))


def _word(numbers: dict[str, float] | None, where: str, mark: changes.Mark) -> str:
    """Returns what git is told of a commit: good, bad or skip."""
    if numbers is None or where not in numbers:
        return "skip"
    from_good, from_bad = (abs(abs(numbers[where]) - abs(each.value)) for each in (mark.before, mark.after))
    return "good" if from_good < from_bad else "bad"


def _git(tree: Path, *words: str, wrong_is_said: bool = False) -> str:
    """Returns what git prints; InputError with its reason if it fails, unless what is wrong is to be returned, too."""
    command = ending_with_this(["git", "-C", str(tree), *words])
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0 and not wrong_is_said:
        raise InputError("git", words[0], done.stderr.strip())
    return done.stdout + (done.stderr if wrong_is_said else "")
