"""Makes build-coverage/COVERAGE.md of what gcovr and pytest-cov have counted: python3 -m tests.clean.coverage_page GCOVR.json COVERAGE.json LEFT_OUT

Every line that no test reaches is named, with the reason where one is known (REASONS). LEFT_OUT says which tests were not run.
"""

from __future__ import annotations

import fnmatch
import json
import re
import sys
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "build-coverage" / "COVERAGE.md"


@dataclass(frozen=True)
class Reason:
    """Why lines whose text holds `pattern`, in files that fit `files`, are not reached."""

    files: str
    pattern: str
    text: str


REASONS = [
    Reason("analysis/nightly/*", "", "tests run nights in copies of the project, which do not count"),
    Reason("*.cpp", r"&&\) noexcept = default;", "moves, which the compiler leaves out where it can"),
    Reason(
        "*.cpp",
        r"^\s*((struct|class) \w+ \{|\}\(\);)$",
        "what the compiler makes of a declaration, and nothing calls",
    ),
    *(
        Reason(
            f"analysis/topics/verification/{name}.py",
            "",
            "`python3 -m analysis verify` runs it, minutes of field solving",
        )
        for name in ("rows", "set_ups", "stage")
    ),
    Reason("analysis/topics/corrections/stage.py", "", "`./run` runs it over 450 set-ups"),
    Reason(
        "*.cpp", r"is not positive definite|positive_definite = false", "no scene is known that leads there"
    ),
]


@dataclass(frozen=True)
class Counted:
    """The lines of a file that hold code, and those among them that no test reaches."""

    path: str
    lines: int
    missed: list[int]

    @property
    def folder(self) -> str:
        """The folder that the table counts it for: two levels deep."""
        return "/".join(Path(self.path).parent.parts[:2])


def of_cpp(report: Any) -> list[Counted]:
    """The files in gcovr's JSON. A line of a template or a header counts as reached when it is in one of its copies."""
    counted = []
    for file in report["files"]:
        times: dict[int, int] = defaultdict(int)
        for line in file["lines"]:
            if not line.get("gcovr/noncode", False):
                times[line["line_number"]] += line["count"]
        if times:
            counted.append(
                Counted(file["file"], len(times), sorted(n for n, count in times.items() if count == 0))
            )
    return counted


def of_python(report: Any) -> list[Counted]:
    """The files in coverage's JSON."""
    return [
        Counted(path, len(file["executed_lines"]) + len(file["missing_lines"]), sorted(file["missing_lines"]))
        for path, file in report["files"].items()
        if file["executed_lines"] or file["missing_lines"]
    ]


def ranges(numbers: list[int], code: set[int]) -> list[tuple[int, int]]:
    """Numbers that follow each other, with nothing else of `code` between them, as first and last."""
    found: list[tuple[int, int]] = []
    for number in numbers:
        if found and not any(between in code for between in range(found[-1][1] + 1, number)):
            found[-1] = (found[-1][0], number)
        else:
            found.append((number, number))
    return found


def reason_for(path: str, first: int, last: int, source: list[str]) -> str:
    text = "\n".join(source[first - 1 : last])
    for reason in REASONS:
        if fnmatch.fnmatch(path, reason.files) and re.search(reason.pattern, text):
            return reason.text
    return ""


def _share(lines: int, missed: int) -> str:
    return f"{100 * (lines - missed) / lines:.1f} %"


def _table(files: list[Counted]) -> list[str]:
    folders: dict[str, list[Counted]] = defaultdict(list)
    for file in files:
        folders[file.folder].append(file)
    rows = ["| folder | lines | not reached | reached |", "|---|---:|---:|---:|"]
    for folder in sorted(folders):
        lines = sum(file.lines for file in folders[folder])
        missed = sum(len(file.missed) for file in folders[folder])
        rows.append(f"| {folder} | {lines} | {missed} | {_share(lines, missed)} |")
    lines, missed = sum(file.lines for file in files), sum(len(file.missed) for file in files)
    rows.append(f"| **all** | {lines} | {missed} | {_share(lines, missed)} |")
    return rows


def _named(file: Counted) -> list[str]:
    """The file's lines that are not reached: those of one reason together, then the others with what stands there."""
    source = (ROOT / file.path).read_text(encoding="utf-8").splitlines()
    by_reason: dict[str, list[str]] = defaultdict(list)
    # What lies between two missed lines is code that is reached unless it is blank, a comment or a bracket.
    code = {
        n
        for n, line in enumerate(source, 1)
        if n not in file.missed and not re.fullmatch(r"\s*((//|#).*|[\])}]*[;,]?)", line)
    }
    for first, last in ranges(file.missed, code):
        place = str(first) if first == last else f"{first}–{last}"
        by_reason[reason_for(file.path, first, last, source)].append(
            place if reason_for(file.path, first, last, source) else f"{place} `{source[first - 1].strip()}`"
        )
    return [
        f"- {file.path}: {', '.join(places)}" + (f" — {reason}" if reason else "")
        for reason, places in by_reason.items()
    ]


def page(cpp: list[Counted], python: list[Counted], left_out: str) -> str:
    parts = [
        "# Lines that the tests reach",
        "",
        "Made by tests/clean/run; nothing here is written by hand. Every line that is not reached is named below, with the reason where",
        "there is one, else with what stands there.",
        "",
        f"Left out: {left_out}.",
    ]
    for title, files in (("C++", cpp), ("Python", python)):
        incomplete = [file for file in sorted(files, key=lambda file: file.path) if file.missed]
        parts += [
            "",
            f"## {title}",
            "",
            *_table(files),
            "",
            *(line for file in incomplete for line in _named(file)),
        ]
    return "\n".join(parts) + "\n"


def main(arguments: list[str]) -> None:
    if len(arguments) != 3:
        sys.exit(__doc__)
    cpp, python = (json.loads(Path(argument).read_text(encoding="utf-8")) for argument in arguments[:2])
    PAGE.write_text(page(of_cpp(cpp), of_python(python), arguments[2]), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
