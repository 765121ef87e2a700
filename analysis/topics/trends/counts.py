"""How many instructions fixed workloads of the model take, counted by callgrind: the same on a busy machine as on an idle one.

Valgrind 3.19 emulates a processor with AVX2 and without AVX-512, so that the counts are those of the AVX2 code whatever the
machine; a machine without AVX2 counts other instructions.
"""

from __future__ import annotations

import hashlib
import re
import shlex
import shutil
import subprocess
from pathlib import Path

from analysis.topics.trends import records
from analysis.topics.trends.records import Record
from geometries.common.children import ending_with_this
from geometries.common.installation import from_repository, model_program

PROGRAM = model_program().with_name("instruction_counts")
# The function of the program that does the work and nothing else.
_COUNTED = "fringe::benchmarks::counted_workload*"
_COLLECTED = re.compile(r"Collected : (\d+)$", re.MULTILINE)
# Longest wait (s) for a workload, which takes seconds.
_LONGEST = 600.0


class CountingFailed(Exception):
    """The program or callgrind did not do what it should; the message says what it printed."""


def of_build(program: Path = PROGRAM) -> list[Record]:
    """Returns the counts of a program; none without it or without valgrind. CountingFailed if one of them cannot be counted."""
    if not (program.is_file() and shutil.which("valgrind")):
        return []
    inputs = hashlib.sha256(program.read_bytes()).hexdigest()
    version = _run(["valgrind", "--version"]).strip()
    again = from_repository(PROGRAM)
    return [
        records.of_count(name, count(name, program), shlex.join(_command(name, again)), inputs, version)
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
    options = [
        "--tool=callgrind",
        "--log-fd=1",
        "--collect-atstart=no",
        f"--toggle-collect={_COUNTED}",
        "--callgrind-out-file=/dev/null",
    ]
    return ["valgrind", *options, program, workload]


def _run(command: list[str]) -> str:
    """Returns the command's standard output; CountingFailed when it is missing, fails, or takes too long."""
    try:
        finished = subprocess.run(
            ending_with_this(command), capture_output=True, text=True, check=False, timeout=_LONGEST
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise CountingFailed(str(error)) from error
    if finished.returncode != 0:
        raise CountingFailed(
            f"{' '.join(command)}: exit code {finished.returncode}: {finished.stderr.strip()}"
        )
    return finished.stdout
