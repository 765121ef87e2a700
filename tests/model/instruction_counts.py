"""How many instructions fixed workloads of the model take, as `analysis.topics.trends.commits` counts them.

`python3 -m tests.model.instruction_counts` records the counts of the build in instruction_counts.json and prints what has
changed; test_instruction_counts.py compares the build with them.
"""

import json
import sys
from dataclasses import dataclass
from pathlib import Path

from analysis.topics.trends.commits import PROGRAM, CountingFailed, count, workloads

ROOT = Path(__file__).resolve().parents[2]
RECORDED = Path(__file__).with_suffix(".json")
RECORD_COMMAND = "python3 -m tests.model.instruction_counts"

# Counts repeat to the last few; a change of the code below this is one of the compiler's mood.
TOLERANCE = 0.05

Counts = dict[str, int]


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
