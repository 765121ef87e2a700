"""Records of scenes with all answers, one line of JSON each: what is kept of a run, and found again by the next one."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from analysis.honesty.methods import Answer, Stated
from analysis.results.answers import Estimate

FILE = "answers.jsonl"


@dataclass
class Record:
    """A scene by its seed and kind, what is known of it in closed form, and its answers by their methods."""

    seed: int
    kind: str
    truths: dict[str, Estimate]
    answers: dict[str, Answer] = field(default_factory=dict)


def load(folder: Path) -> dict[int, Record]:
    """Returns the records of a folder by their seeds: of several of one scene all answers, the last one of each method. A line that was
    not finished is left out."""
    found: dict[int, Record] = {}
    file = folder / FILE
    for line in file.read_text(encoding="utf-8").splitlines() if file.is_file() else []:
        try:
            record = _record(json.loads(line))
        except (ValueError, KeyError, TypeError):
            continue
        before = found.setdefault(record.seed, record)
        before.answers |= record.answers
    return found


def append(folder: Path, record: Record) -> None:
    """Adds a record to those of a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / FILE).open("a", encoding="utf-8") as file:
        file.write(json.dumps(asdict(record)) + "\n")


def _record(document: dict[str, Any]) -> Record:
    truths = {name: Estimate(**known) for name, known in document["truths"].items()}
    answers = {name: answer(each) for name, each in document["answers"].items()}
    return Record(document["seed"], document["kind"], truths, answers)


def answer(document: dict[str, Any]) -> Answer:
    """Reads a stored answer."""
    values = {name: Stated(**stated) for name, stated in document["values"].items()}
    return replace(Answer(**document), values=values)
