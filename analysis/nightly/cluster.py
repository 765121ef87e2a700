"""Ends the jobs that a night has on a cluster when the night ends before them.

All jobs of a folder of results have one name. While a night may have some, a file in that folder says by which profile; a night that
was killed leaves it behind, and whoever works in the folder next ends those jobs first: no case is ever solved twice at once.
"""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import sys
from pathlib import Path

from analysis.nightly.chunks import FOLDER
from analysis.pipeline.processes import Finished
from analysis.results.store import write_text

NAME_VARIABLE = "FRINGE_JOBS"
"""The environment variable that gives the jobs' name to Snakemake and to a profile's commands."""
CANCEL = "cancel.py"
"""In a profile's folder: called with the name, it ends all jobs of that name and returns when none is left. A profile without one has
jobs that end by themselves after the case they are at."""
_MARK = "cluster.txt"


def name(folder: Path) -> str:
    """Returns the name of the jobs of a folder of results, the same every night."""
    return f"fringe-{hashlib.sha256(str(folder.resolve()).encode()).hexdigest()[:16]}"


def begin(folder: Path, profile: Path | None) -> None:
    """Ends the jobs that an earlier night left, and stores the profile (None: this machine) of the night that begins."""
    end_left_over(folder)
    if profile is not None:
        write_text(folder / _MARK, str(profile))
        # Jobs of a deleted folder of the same name, whose mark is gone too.
        _cancel(folder, profile)


def end(folder: Path) -> None:
    """Removes the jobs' files and ends the jobs that are still on the cluster; OSError if that fails."""
    # A job that starts from here on finds no file and does nothing.
    shutil.rmtree(folder / FOLDER, ignore_errors=True)
    mark = folder / _MARK
    if mark.is_file():
        _cancel(folder, Path(mark.read_text(encoding="utf-8")))
        mark.unlink()


def end_left_over(folder: Path) -> None:
    """Does the same for a night that was killed, if there was one."""
    if (folder / _MARK).is_file():
        end(folder)


def _cancel(folder: Path, profile: Path) -> None:
    program = profile / CANCEL
    if not program.is_file():
        return
    # It goes on if this process is killed: jobs are not this machine's children.
    done = subprocess.run(
        [sys.executable, str(program), name(folder)], capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        reason = Finished(done.returncode, done.stdout, done.stderr).reason
        raise OSError(f"jobs called {name(folder)} may be left on the cluster: {reason}")
