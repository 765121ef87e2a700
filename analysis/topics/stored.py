"""Records of set-ups that are kept beside the code of their topic, by the hash of the scene, so that nobody has to solve them again."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, NamedTuple

from analysis.pipeline.set_up_stages import SomeSetUp
from analysis.pipeline.stage import NoAnswer
from analysis.results.store import Document, read_json, write_json

_DIGITS = 7
"""Significant digits of a rounded value: far more than are true."""


class Completed(NamedTuple):
    """How many set-ups were solved, and how many remain without a record."""

    solved: int
    left: int


@dataclass(frozen=True)
class Stored(Generic[SomeSetUp]):
    """The records of the set-ups `chosen` in a file, in which they stand after the `description`.

    `solve` makes a record; NoAnswer where there is none.
    """

    file: Path
    description: str
    chosen: Callable[[], Iterable[SomeSetUp]]
    solve: Callable[[SomeSetUp], Document]

    @property
    def key(self) -> str:
        """What the records are called in the file: truths or checks."""
        return self.file.stem.removeprefix("field_")

    def records(self) -> Document:
        """Returns the records by the identity of their set-up's scene; none without a file."""
        document = read_json(self.file)
        found: Document = {} if document is None else document[self.key]
        return found

    def complete(self, set_ups: Iterable[SomeSetUp] | None = None, seconds: float = math.inf) -> Completed:
        """Solves those of the set-ups, all chosen ones if none are given, that have no record, and begins none after these seconds. Drops the
        records of what is none of them. Each record is written at once."""
        asked, known = list(self.chosen() if set_ups is None else set_ups), self.records()
        records = {each.identity: known[each.identity] for each in asked if each.identity in known}
        solved, end = 0, time.monotonic() + seconds
        for each in asked:
            if each.identity in records or time.monotonic() >= end:
                continue
            before = time.monotonic()
            try:
                records[each.identity] = self.solve(each)
            except NoAnswer as reason:
                print(f"{each.name}: {reason}", file=sys.stderr, flush=True)
                continue
            self.write(records)
            solved += 1
            print(f"{each.name}: {time.monotonic() - before:.0f} s", file=sys.stderr, flush=True)
        if records.keys() != known.keys():
            self.write(records)
        return Completed(solved, sum(each.identity not in records for each in asked))

    def write(self, records: Document) -> None:
        """Replaces the records."""
        write_json(self.file, {"description": self.description, self.key: records})


def rounded(record: Document) -> Document:
    """Returns a record with its numbers rounded."""
    return {key: _rounded(value) for key, value in record.items()}


def _rounded(value: Any) -> Any:
    if isinstance(value, dict):
        return rounded(value)
    if isinstance(value, list):
        return [_rounded(each) for each in value]
    return float(f"{value:.{_DIGITS}g}") if isinstance(value, float) else value
