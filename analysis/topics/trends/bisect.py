"""Finds the commit that changed a value: `git bisect` in a working tree of its own, where each commit is built and asked again."""

from __future__ import annotations

import json
import re
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from analysis.topics.trends import changes, records
from analysis.topics.trends.changes import Mark
from geometries.common.errors import InputError
from geometries.common.installation import ROOT

BUILD = "cmake --preset release && cmake --build build --target product instruction_counts"
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
_DIRTY = "-dirty"


def find(folder: Path, name: str, repository: Path = ROOT, build: str = BUILD) -> str:
    """Returns what git says of the first commit after which the value was nearer to what it is since its last change than to what it
    was before; InputError if there is no such change, or its commits are not known.

    `name` is the value's, or `KIND: NAME` if several methods have one of that name. Commits that cannot be built are passed over.
    """
    mark = _last(folder, name)
    good, bad = (each.commit.removesuffix(_DIRTY) for each in (mark.before, mark.after))
    with tempfile.TemporaryDirectory() as place:
        tree = Path(place) / "tree"
        _git(repository, "worktree", "add", "--detach", str(tree), bad)
        try:
            # The commands name scenes in the folder of results, which git does not have.
            (tree / "results").symlink_to(repository / "results")
            _git(tree, "checkout", "--detach", good)
            where = _nearest(_numbers(tree, mark, build) or {}, mark.before.value, name)
            said = _git(tree, "bisect", "start", bad, good)
            while "is the first bad commit" not in said and "only 'skip'ped commits left" not in said:
                said = _git(
                    tree, "bisect", _word(_numbers(tree, mark, build), where, mark), wrong_is_said=True
                )
            return said
        finally:
            _git(repository, "worktree", "remove", "--force", str(tree))


def _last(folder: Path, name: str) -> Mark:
    known = [
        mark
        for mark in changes.marks(records.load(folder))
        if name in (mark.after.name, ": ".join(mark.after.series))
    ]
    if not known:
        raise InputError(name, "", "is no value that has changed")
    before, after = known[-1].before, known[-1].after
    if before.commit == after.commit or "unknown" in (before.commit, after.commit):
        raise InputError(name, "", "has not changed between two commits that are known")
    return known[-1]


def _numbers(tree: Path, mark: Mark, build: str) -> dict[str, float] | None:
    """Returns the numbers that the value's command prints there, by their places; None where it cannot be built or fails."""
    for command in (build, mark.after.command):
        done = subprocess.run(command, shell=True, cwd=tree, capture_output=True, text=True, check=False)
        # Status 3 is that of an answer short of the accuracy asked for.
        if done.returncode not in (0, 3):
            return None
    try:
        return dict(_flat(json.loads(done.stdout), ""))
    except ValueError:
        return {str(place): float(found) for place, found in enumerate(_NUMBER.findall(done.stdout))}


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


def _word(numbers: dict[str, float] | None, where: str, mark: Mark) -> str:
    """Returns what git is told of a commit: good, bad or skip."""
    if numbers is None or where not in numbers:
        return "skip"
    from_good, from_bad = (abs(abs(numbers[where]) - abs(each.value)) for each in (mark.before, mark.after))
    return "good" if from_good < from_bad else "bad"


def _git(tree: Path, *words: str, wrong_is_said: bool = False) -> str:
    """Returns what git prints; InputError with its reason if it fails, unless what is wrong is to be returned, too."""
    done = subprocess.run(["git", "-C", str(tree), *words], capture_output=True, text=True, check=False)
    if done.returncode != 0 and not wrong_is_said:
        raise InputError("git", words[0], done.stderr.strip())
    return done.stdout + done.stderr
