"""The jobs of a night: files that name the cases of a job, files in which finished jobs report their failures, and how those are ended that a night has on a cluster
when it ends before them.

All jobs of a folder of results have one name. While a night may have some on a cluster, a file in that folder says by which profile; a night that was killed leaves it
behind, and whoever works in the folder next ends those jobs first: no case is ever solved twice at once."""

from __future__ import annotations

import hashlib
import json
import shutil
import subprocess
import sys
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from analysis.pipeline import reference_stage
from analysis.pipeline.stage import Finished
from analysis.results.store import Document, is_current, read_json, write_json, write_text
from analysis.results.study_results import Failure, case_folder
from analysis.study import workflow
from analysis.study.workflow import Work
from geometries.common.errors import InputError
from geometries.studies.study import Study


# The folder of a night's jobs, within the results; every night makes it anew.
FOLDER = "jobs"
_ENDED = ".ended.json"
# Most jobs of a night. Snakemake checks all jobs repeatedly, which takes two seconds for a thousand.
_MOST = 1000


@dataclass(frozen=True)
class Chunk:
    """Cases that one job solves, one after the other."""

    name: str
    works: list[Work]


def group(works: list[Work], seconds: float, workers: int) -> list[Chunk]:
    """Groups the cases into jobs of about `seconds` each: shorter if some workers would have none, and at most a thousand.

    The costly cases come first, and each goes to the job that has least to do.
    """
    total = sum(work.cost for work in works)
    count = min(len(works), _MOST, max(workers, round(total / seconds)))
    if count == 0:
        return []
    # Dealt out like cards, back and forth: equal up to one case, and fast for a hundred thousand cases.
    hands: list[list[Work]] = [[] for _ in range(count)]
    for number, work in enumerate(sorted(works, key=lambda work: -work.cost)):
        turn, place = divmod(number, count)
        hands[count - 1 - place if turn % 2 else place].append(work)
    # Names differ from night to night: a job left over from an earlier night must not find a file of the same name.
    night = f"{time.time_ns():x}"
    return [Chunk(f"{night}-{number:04}", hand) for number, hand in enumerate(hands)]


def write(chunks: list[Chunk], study: Study, results: Path) -> None:
    """Writes a file for each job into the results' folder of jobs."""
    asked = {
        "rtol": study.rtol,
        "max_seconds": study.max_seconds,
        "error": study.error,
        "methods": list(study.methods),
        "reference_method": study.reference_method,
    }
    for chunk in chunks:
        document: Document = {"asked": asked, "works": [vars(work) for work in chunk.works]}
        # On one line, which is several times as fast to write; there may be a hundred thousand cases.
        write_text(results / FOLDER / f"{chunk.name}.json", json.dumps(document))


def solve(file: Path) -> None:
    """Solves the unanswered cases of a job's file, then writes its failures beside it; InputError if there is no such file.

    Stops silently when the file disappears: another night has begun and has taken over the remaining cases.
    """
    document = read_json(file)
    if document is None:
        raise InputError(str(file), "", "is not the file of a job")
    asked = document["asked"]
    asked["methods"] = tuple(asked["methods"])
    study = Study(name="", title="", sweeps=(), **asked)
    results = file.resolve().parent.parent
    failures: list[Failure] = []
    for entry in document["works"]:
        if not file.is_file():
            return
        work = _left(Work(**entry), results)
        failures += workflow.compute(work, study, results)
    write_json(file.with_name(file.stem + _ENDED), {"failures": [asdict(failure) for failure in failures]})


def failures(chunks: list[Chunk], results: Path) -> list[Failure]:
    """Returns the failures that the jobs report, and one for every answer that is missing without a report."""
    found: list[Failure] = []
    for chunk in chunks:
        report = read_json(results / FOLDER / (chunk.name + _ENDED))
        if report is not None:
            found += [Failure(**failure) for failure in report["failures"]]
        else:
            lost = [work.case for work in chunk.works if _left(work, results).keys]
            found += [
                Failure(case, reference_stage.SOLVE, "its job ended without an answer; see snakemake.log")
                for case in lost
            ]
    return found


def _left(work: Work, results: Path) -> Work:
    """Returns what is still to do: a job that was killed earlier may have done some of it."""
    place = case_folder(results, work.case)
    keys = {file: key for file, key in work.keys.items() if not is_current(place / file, key)}
    return replace(work, keys=keys)


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
