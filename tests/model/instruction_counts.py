"""How many instructions fixed workloads of the model take, counted by callgrind: the same on a busy machine as on an idle one.

`python3 -m tests.model.instruction_counts` records the counts of the build in instruction_counts.json and prints what has
changed; test_instruction_counts.py compares the build with them.

Valgrind 3.19 emulates a processor with AVX2 and without AVX-512, so that the counts are those of the AVX2 code whatever the
machine; a machine without AVX2 counts other instructions.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from tests.waiting import DEADLINE

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "build" / "bin" / "instruction_counts"
RECORDED = Path(__file__).with_suffix(".json")
RECORD_COMMAND = "python3 -m tests.model.instruction_counts"

# Counts repeat to the last few; a change of the code below this is one of the compiler's mood.
TOLERANCE = 0.05
# The function of the program that does the work and nothing else.
_COUNTED = "fringe::benchmarks::counted_workload*"
_TOTALS = re.compile(r"^totals: (\d+)$", re.MULTILINE)

Counts = dict[str, int]


class CountingFailed(Exception):
    """The program or callgrind did not do what it should; the message says what it printed."""


@dataclass(frozen=True)
class Comparison:
    """Lines for people. `slower` and `unmatched` are failures, `faster` is a hint."""

    slower: list[str]
    faster: list[str]
    unmatched: list[str]

    @property
    def failed(self) -> bool:
        return bool(self.slower or self.unmatched)

    def __str__(self) -> str:
        """All lines, with what to do about them; empty when every count is within the tolerance."""
        parts = []
        if self.slower:
            parts += [f"more than {TOLERANCE:.0%} above the recorded count:", *self.slower]
        if self.unmatched:
            parts += ["recorded and built workloads differ:", *self.unmatched]
        if self.faster:
            parts += [f"more than {TOLERANCE:.0%} below the recorded count, worth recording:", *self.faster]
        if parts:
            parts.append(
                f"If this is intended, record the counts with `{RECORD_COMMAND}` and commit {RECORDED.name}."
            )
        return "\n".join(parts)


def workloads(program: Path = PROGRAM) -> list[str]:
    """The names of the program's workloads."""
    return _run([str(program), "--list"]).split()


def count(workload: str, program: Path = PROGRAM) -> int:
    """The instructions of one workload, without its preparation; CountingFailed when there is no such count."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "callgrind.out"
        _run(
            [
                "valgrind",
                "--tool=callgrind",
                "--collect-atstart=no",
                f"--toggle-collect={_COUNTED}",
                f"--callgrind-out-file={out}",
                str(program),
                workload,
            ]
        )
        found = _TOTALS.search(out.read_text(encoding="utf-8"))
    # Without the function's name in the program callgrind would count nothing, and nothing would ever be slow.
    if found is None or int(found[1]) == 0:
        raise CountingFailed(f"{workload}: callgrind counted nothing")
    return int(found[1])


def count_all(program: Path = PROGRAM) -> Counts:
    """The instructions of every workload."""
    return {workload: count(workload, program) for workload in workloads(program)}


def recorded(path: Path = RECORDED) -> Counts:
    """The recorded counts."""
    counts: Counts = json.loads(path.read_text(encoding="utf-8"))
    return counts


def compare(old: Counts, new: Counts) -> Comparison:
    """What has changed beyond the tolerance from `old`, the recorded counts, to `new`."""
    common = [name for name in new if name in old]
    return Comparison(
        slower=[_change(name, old, new) for name in common if new[name] > (1 + TOLERANCE) * old[name]],
        faster=[_change(name, old, new) for name in common if new[name] < (1 - TOLERANCE) * old[name]],
        unmatched=[f"  {name}: not recorded" for name in new if name not in old]
        + [f"  {name}: recorded, but the program has no such workload" for name in old if name not in new],
    )


def record(path: Path = RECORDED, program: Path = PROGRAM) -> list[str]:
    """Count every workload and write the counts down; returns a line for each, old or new, with its change.

    CountingFailed, and nothing written, when one of them cannot be counted.
    """
    old = recorded(path) if path.is_file() else {}
    new = count_all(program)
    path.write_text(json.dumps(new, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    gone = [f"  {name}: {old[name]:,}, dropped" for name in old if name not in new]
    return [_change(name, old, new) for name in new] + gone


def _change(name: str, old: Counts, new: Counts) -> str:
    if name not in old:
        return f"  {name}: {new[name]:,}, for the first time"
    return f"  {name}: {old[name]:,} -> {new[name]:,} ({new[name] / old[name] - 1:+.1%})"


def _run(command: list[str]) -> str:
    """The command's standard output; CountingFailed when it is missing, fails, or takes too long."""
    try:
        finished = subprocess.run(command, capture_output=True, text=True, check=False, timeout=DEADLINE)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise CountingFailed(str(error)) from error
    if finished.returncode != 0:
        raise CountingFailed(
            f"{' '.join(command)}: exit code {finished.returncode}: {finished.stderr.strip()}"
        )
    return finished.stdout


def main() -> int:
    """Record the counts and print what has changed; returns the exit code."""
    try:
        lines = record()
    except CountingFailed as error:
        print(f"instruction_counts: nothing recorded: {error}", file=sys.stderr)
        return 1
    print(f"{RECORDED.relative_to(ROOT)}: instructions for each workload", *lines, sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
