"""The section on `python3 -m tests.faults.run`, which injects faults into a running study and counts the consequences."""

from __future__ import annotations

from pathlib import Path

from markupsafe import Markup

from analysis.report import page
from analysis.results.store import Document, read_json

FOLDER, FILE = "faults", "faults.json"
TITLE = "Faults during a study"
_KINDS = {
    "killed": "killed (SIGKILL), alone or with all it has started",
    "terminated": "SIGTERM",
    "interrupted": "Ctrl-C, now and then twice",
    "two_at_once": "a second run of the same study",
    "folder_removed": "the folder of results removed",
    "no_space": "no space left on the file system",
    "read_only": "a read-only file system",
    "write_fails": "files that cannot grow",
    "no_memory": "memory limited",
    "clock_jumps": "the clock set back and ahead by years",
}


def beside(results: Path) -> Document | None:
    """Returns the counts in the folder that belongs to a study's results; None without any."""
    return read_json(results.resolve().parent / FOLDER / FILE)


def section(document: Document) -> Markup:
    kinds = {name: counts for name, counts in document["kinds"].items() if counts["rounds"]}
    table = page.table_of(
        kinds.items(),
        ("fault", lambda kind: _KINDS.get(kind[0], kind[0])),
        ("made", lambda kind: str(kind[1]["rounds"])),
        ("while it ran", lambda kind: str(kind[1]["during_the_run"])),
        ("unfinished files left", lambda kind: str(kind[1]["unfinished_files"])),
        ("completed by the next run", lambda kind: str(kind[1]["completed_afterwards"])),
    )
    return page.section(
        TITLE,
        page.finding(finding(document)),
        table,
        page.folded("What the user reads", _messages(kinds)),
        page.soft(
            "Reference and model answer at once here; the commands and all that they write are the real ones. After every fault "
            "each file under its own name was whole, no finished answer was lost or changed, and the same command, left alone, "
            "made the table of an undisturbed run; otherwise there would be no counts. Made anew by python3 -m tests.faults.run."
        ),
    )


def _messages(kinds: dict[str, Document]) -> Markup:
    """Returns the first sentence of every kind that had one."""
    return Markup("").join(
        page.paragraph(f"{_KINDS.get(name, name)}: “{counts['sentences'][0].removeprefix('analysis: ')}”")
        for name, counts in kinds.items()
        if counts["sentences"]
    )


def finding(document: Document) -> str:
    counts = [entry for entry in document["kinds"].values() if entry["rounds"]]
    made, completed = (sum(entry[key] for entry in counts) for key in ("rounds", "completed_afterwards"))
    return (
        f"Of {made} faults, {sum(entry['during_the_run'] for entry in counts)} while the study ran, none lost or damaged a finished "
        f"answer, and after {completed} of them the next run completed the study."
    )
