"""Runs a study's missing answers by Snakemake on this machine's cores or, with a profile, on a cluster.

What is to do is found before, by the keys of the stored answers. Snakemake gets jobs of several cases each, in a folder that
every night makes anew, so nothing that an earlier night left there, however it ended, has to be unlocked or repaired.
"""

from __future__ import annotations

import shlex
import shutil
import sys
import threading
from dataclasses import dataclass
from pathlib import Path

from analysis.nightly import chunks
from analysis.pipeline.scheduler import Progress, parallel_jobs
from analysis.pipeline.stage import Processes, environment_of_modules, forget_unfinished_forms
from analysis.results.store import write_text
from analysis.results.study_results import Failure, case_folder, write_manifest
from analysis.study import workflow
from analysis.study.workflow import Work
from analysis.topics.trade_off import measure as trade_off
from geometries.common.children import ENDS_WITH_PARENT
from geometries.common.errors import InputError
from geometries.common.installation import ROOT
from geometries.studies.study import Study

LOG = "snakemake.log"
_PROFILES = Path(__file__).parent / "profiles"
_SNAKEFILE = Path(__file__).parent / "Snakefile"
# Interval (s) at which the progress bar looks for stored answers.
_LOOK_SECONDS = 1.0
# Expected length of a job (s): minutes on a cluster, where starting one takes seconds; less here.
_SECONDS_HERE, _SECONDS_ON_A_CLUSTER = 60.0, 600.0


@dataclass(frozen=True)
class Options:
    """How a night is carried: Snakemake's profile (None: this machine), jobs at a time and expected seconds of a job, None
    means a suitable value."""

    profile: str | None = None
    workers: int | None = None
    job_seconds: float | None = None


def run(study: Study, folder: Path, options: Options) -> list[Failure]:
    """Brings every case of the study up to date in `folder`; returns what failed. KeyboardInterrupt ends it at once, with its jobs on a
    cluster; what was finished stays."""
    workers = options.workers or parallel_jobs()
    seconds = options.job_seconds or (_SECONDS_ON_A_CLUSTER if options.profile else _SECONDS_HERE)
    profile = find_profile(options.profile) if options.profile else None
    chunks.begin(folder, profile)
    cases = study.cases()
    works = workflow.missing(study, cases, folder)
    prepared = prepare(works, study, folder, seconds, workers)
    workflow.measure(folder, wanted=False)
    trade_off.run(folder, [case.identity for case in cases], wanted=False)
    failures: list[Failure] = []
    try:
        if prepared:
            _carry(prepared, folder, command(folder, profile, workers), workers)
            failures = chunks.failures(prepared, folder)
            # A job that never started has written no scenes, but the report shows every case.
            workflow.write_scenes(works, folder)
    finally:
        chunks.end(folder)
    write_manifest(folder, study, failures)
    return failures


def prepare(
    works: list[Work], study: Study, folder: Path, seconds: float, workers: int
) -> list[chunks.Chunk]:
    """Removes outdated answers and the jobs of an earlier night, and writes the files of the jobs for the missing answers."""
    if (folder / chunks.FOLDER).exists():
        shutil.rmtree(folder / chunks.FOLDER)
    workflow.forget(works, folder)
    forget_unfinished_forms()
    grouped = chunks.group(works, seconds, workers)
    chunks.write(grouped, study, folder)
    return grouped


def command(folder: Path, profile: Path | None, workers: int) -> list[str]:
    """Returns Snakemake's command line for the jobs in a folder."""
    job = [*ENDS_WITH_PARENT, sys.executable, "-P", "-m", "analysis", "job"]
    where = ["--cores", str(workers)] if profile is None else ["--profile", str(profile)]
    return [
        *(sys.executable, "-m", "snakemake", "--snakefile", str(_SNAKEFILE)),
        *("--directory", str((folder / chunks.FOLDER).resolve())),
        *("--config", f"command={shlex.join(job)}"),
        # The folder belongs to this night alone and is deleted afterwards.
        *("--nolock", "--drop-metadata", "--rerun-incomplete", "--rerun-triggers", "mtime"),
        # A job succeeds even if cases fail; one that does not was killed, perhaps for lack of memory.
        *("--keep-going", "--retries", "1"),
        *("--scheduler", "greedy", "--nocolor"),
        *where,
    ]


def find_profile(profile: str) -> Path:
    """Returns the folder of a profile given by its name in `analysis/nightly/profiles` or by its path; InputError when there is none."""
    for place in (_PROFILES / profile, Path(profile)):
        if (place / "config.yaml").is_file():
            return place.resolve()
    known = ", ".join(sorted(path.name for path in _PROFILES.iterdir()))
    raise InputError(
        profile, "", f"is neither a folder with a config.yaml nor one of the known profiles: {known}"
    )


def _carry(jobs: list[chunks.Chunk], folder: Path, command: list[str], workers: int) -> None:
    """Runs Snakemake to its end, with a progress bar; its output goes to a file."""
    processes, ended = Processes(), threading.Event()
    printed: list[str] = []
    environment = environment_of_modules() | {chunks.NAME_VARIABLE: chunks.name(folder)}

    def snakemake() -> None:
        try:
            finished = processes.run(command, ROOT, environment)
            printed.extend([finished.output, finished.errors])
        finally:
            ended.set()

    thread = threading.Thread(target=snakemake)
    thread.start()
    try:
        _show(jobs, folder, workers, ended)
    except BaseException:
        processes.stop()
        raise
    finally:
        thread.join()
    write_text(folder / LOG, "\n".join([shlex.join(command), *printed]))


def _show(jobs: list[chunks.Chunk], folder: Path, workers: int, ended: threading.Event) -> None:
    """Shows the progress, counted by stored answers, until Snakemake has ended."""
    left = {
        case_folder(folder, work.case) / file: cost
        for job in jobs
        for work in job.works
        for file, cost in work.seconds.items()
    }
    count = len(left)
    with Progress(sum(left.values()), count, workers) as progress:
        while True:
            over = ended.wait(_LOOK_SECONDS)
            done = [path for path in left if path.is_file()]
            if done:
                progress.advance(sum(left.pop(path) for path in done))
            if done or sys.stderr.isatty():
                progress.tell(count - len(left))
            if over:
                return
