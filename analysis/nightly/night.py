"""Runs a study's missing answers by Snakemake on this machine's cores or, with a profile, on a cluster.

What is to do is found before, by the keys of the stored answers. Snakemake gets jobs of several cases each: files that name the cases of a job, and files in which
finished jobs report their failures, in a folder that every night makes anew, so nothing that an earlier night left there, however it ended, has to be unlocked or repaired.

All jobs of a folder of results have one name. While a night may have some on a cluster, a file in that folder says by which profile; a night that was killed leaves it
behind, and whoever works in the folder next ends those jobs first: no case is ever solved twice at once."""

import hashlib
import json
import shlex
import shutil
import subprocess
import sys
import threading
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from analysis.pipeline import reference_stage
from analysis.pipeline.scheduler import Progress, parallel_jobs
from analysis.pipeline.stage import Finished, Processes, environment_of_modules, forget_unfinished_forms
from analysis.results.store import Document, is_current, read_json, write_json, write_text
from analysis.results.study_results import Failure, asked, case_folder, write_manifest
from analysis.study import workflow
from analysis.study.workflow import Work
from analysis.topics.trade_off import measure as trade_off
from geometries.common.children import ENDS_WITH_PARENT
from geometries.common.errors import InputError
from geometries.common.installation import ROOT
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
    The costly cases come first, and each goes to the job that has least to do."""
    total = sum(work.cost for work in works)
    count = min(len(works), _MOST, max(workers, round(total / seconds)))
    # Dealt out like cards, back and forth: equal up to one case, and fast for a hundred thousand cases.
    hands: list[list[Work]] = [[] for _ in range(count)]
    for number, work in enumerate(sorted(works, key=lambda work: -work.cost)):
        turn, place = divmod(number, count)
        hands[count - 1 - place if turn % 2 else place].append(work)
    # Names differ from night to night: a job left over from an earlier night must not find a file of the same name.
    night = f"{time.time_ns():x}"
    return [Chunk(f"{night}-{number:04}", hand) for number, hand in enumerate(hands)]


def solve(file: Path) -> None:
    """Solves the unanswered cases of a job's file, then writes its failures beside it; InputError if there is no such file.
    Stops silently when the file disappears: another night has begun and has taken over the remaining cases.
    """
    document = read_json(file)
    if document is None:
        raise InputError(str(file), "", "is not the file of a job")
    methods = {"methods": tuple(document["asked"]["methods"])}
    study = Study(name="", title="", sweeps=(), **document["asked"] | methods)
    results = file.resolve().parent.parent
    failures: list[Failure] = []
    for entry in document["works"]:
        if not file.is_file():
            return
        work = _left(Work(**entry), results)
        failures += workflow.compute(work, study, results)
    write_json(file.with_name(file.stem + _ENDED), {"failures": [asdict(failure) for failure in failures]})


def failures_of_jobs(chunks: list[Chunk], results: Path) -> list[Failure]:
    """Returns the failures that the jobs report, and one for every answer that is missing without a report."""
    found: list[Failure] = []
    for chunk in chunks:
        report = read_json(results / FOLDER / (chunk.name + _ENDED))
        if report is not None:
            found += [Failure(**failure) for failure in report["failures"]]
        else:
            lost = (work.case for work in chunk.works if _left(work, results).keys)
            reason = "its job ended without an answer; see snakemake.log"
            found += [Failure(case, reference_stage.SOLVE, reason) for case in lost]
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


def name_of_jobs(folder: Path) -> str:
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
    command = [sys.executable, str(program), name_of_jobs(folder)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        reason = Finished(done.returncode, done.stdout, done.stderr).reason
        raise OSError(f"jobs called {name_of_jobs(folder)} may be left on the cluster: {reason}")


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
    begin(folder, profile)
    cases = study.cases()
    works = workflow.missing(study, cases, folder)
    prepared = prepare(works, study, folder, seconds, workers)
    workflow.measure(folder, wanted=False)
    trade_off.run(folder, [case.identity for case in cases], wanted=False)
    failures: list[Failure] = []
    try:
        if prepared:
            _carry(prepared, folder, command(folder, profile, workers), workers)
            failures = failures_of_jobs(prepared, folder)
            # A job that never started has written no scenes, but the report shows every case.
            workflow.write_scenes(works, folder)
    finally:
        end(folder)
    write_manifest(folder, study, failures)
    return failures


def prepare(works: list[Work], study: Study, folder: Path, seconds: float, workers: int) -> list[Chunk]:
    """Removes outdated answers and the jobs of an earlier night, and writes the files of the jobs for the missing answers."""
    if (folder / FOLDER).exists():
        shutil.rmtree(folder / FOLDER)
    workflow.forget(works, folder)
    forget_unfinished_forms()
    grouped = group(works, seconds, workers)
    for chunk in grouped:
        document: Document = {"asked": asked(study), "works": [vars(work) for work in chunk.works]}
        # On one line, which is several times as fast to write; there may be a hundred thousand cases.
        write_text(folder / FOLDER / f"{chunk.name}.json", json.dumps(document))
    return grouped


def command(folder: Path, profile: Path | None, workers: int) -> list[str]:
    """Returns Snakemake's command line for the jobs in a folder."""
    job = [*ENDS_WITH_PARENT, sys.executable, "-P", "-m", "analysis", "job"]
    where = ["--cores", str(workers)] if profile is None else ["--profile", str(profile)]
    return [
        *(sys.executable, "-m", "snakemake", "--snakefile", str(_SNAKEFILE)),
        *("--directory", str((folder / FOLDER).resolve())),
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
    reason = f"is neither a folder with a config.yaml nor one of the known profiles: {known}"
    raise InputError(profile, "", reason)


def _carry(jobs: list[Chunk], folder: Path, command: list[str], workers: int) -> None:
    """Runs Snakemake to its end, with a progress bar; its output goes to a file."""
    processes, ended = Processes(), threading.Event()
    printed: list[str] = []
    environment = environment_of_modules() | {NAME_VARIABLE: name_of_jobs(folder)}

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


def _show(jobs: list[Chunk], folder: Path, workers: int, ended: threading.Event) -> None:
    """Shows the progress, counted by stored answers, until Snakemake has ended."""
    left: dict[Path, float] = {}
    for work in (work for job in jobs for work in job.works):
        left |= {case_folder(folder, work.case) / file: cost for file, cost in work.seconds.items()}
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
