"""`cancel.py NAME`: end every job of that name that this user has in SLURM, waiting or running; returns when none is left.

Status 1, with what SLURM says, when there are still some after minutes, or when it does not answer."""

from __future__ import annotations

import subprocess
import sys
import time

# SLURM itself kills a job half a minute after it was asked to end; a node that does not answer takes longer.
_PATIENCE_SECONDS = 180.0
_LOOK_SECONDS = 0.3


def main(name: str) -> int:
    whose = ["--me", f"--name={name}"]
    end = time.monotonic() + _PATIENCE_SECONDS
    while True:
        left = _run(["squeue", "--noheader", "--format=%i %T", *whose])
        if left.returncode == 0 and not left.stdout.strip():
            return 0
        if left.returncode != 0 or time.monotonic() > end:
            print((left.stderr or f"still there: {left.stdout}").strip(), file=sys.stderr)
            return 1
        # What waits is taken away first, or else it would begin when what runs has ended. Answers are written whole or not at all:
        # nothing has to be ended gently. A job that has ended meanwhile is no failure.
        _run(["scancel", "--quiet", "--state=PENDING", *whose])
        _run(["scancel", "--quiet", "--signal=KILL", "--full", *whose])
        time.sleep(_LOOK_SECONDS)


def _run(command: list[str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command, capture_output=True, text=True, check=False)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
