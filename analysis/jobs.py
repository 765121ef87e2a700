"""Jobs run side by side, as many as cores and memory allow, with a progress bar that shows the remaining time."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import Any

from analysis.processes import Processes, Stopped

# What one solve of the reference may take at its finest level, with room to spare.
_MEMORY_PER_JOB = 3 * 2**30
_REFRESH_SECONDS = 1.0


@dataclass(frozen=True)
class Failure:
    """A case that a stage could not answer, and why. Without a case it is a measurement of the model by itself."""

    case: str
    stage: str
    reason: str


@dataclass(frozen=True)
class Job:
    """Work for one case or one measurement. `cost` is its expected seconds; `work` returns a failure or None."""

    cost: float
    work: Callable[[Processes], Failure | None]


def parallel_jobs() -> int:
    """How many jobs this machine carries: by its cores, and by the memory that is free now."""
    import psutil

    cores = len(os.sched_getaffinity(0))
    return max(1, min(cores, int(psutil.virtual_memory().available) // _MEMORY_PER_JOB))


def run_all(jobs: list[Job], workers: int, done: str = "solved") -> list[Failure]:
    """Run the jobs, the costly ones first so that none is left over at the end; returns the failures.

    `done` is what the progress bar says of those that have ended.

    KeyboardInterrupt ends the running jobs' processes, starts no more, and is raised again.
    """
    processes = Processes()
    ordered = sorted(jobs, key=lambda job: -job.cost)
    with ThreadPoolExecutor(workers) as pool:
        try:
            futures = {pool.submit(_run, job, processes): job for job in ordered}
            return [failure for failure in _watch(futures, workers, done) if failure is not None]
        except BaseException:
            processes.stop()
            pool.shutdown(cancel_futures=True)
            raise


def remaining_seconds(total: float, done: float, elapsed: float, workers: int) -> float:
    """How long the rest takes, by the pace so far; before the first job has ended, by its expected seconds."""
    if done == 0:
        return max(0.0, total / workers - elapsed)
    return elapsed * (total - done) / done


def _watch(futures: dict[Future[Failure | None], Job], workers: int, done: str) -> Iterator[Failure | None]:
    """The jobs' outcomes as they come, with a progress bar that counts expected cost rather than jobs."""
    from tqdm import tqdm

    total, pending = sum(job.cost for job in futures.values()), set(futures)
    layout = "{desc} {bar} {percentage:3.0f} %, {elapsed} gone{postfix}"
    # A terminal shows the time running; a log gets a line for each finished job only.
    patience = _REFRESH_SECONDS if sys.stderr.isatty() else None
    with tqdm(total=total, bar_format=layout, ncols=100) as bar:
        _show(bar, f"0 of {len(futures)} {done}", workers)
        while pending:
            finished, pending = wait(pending, patience, FIRST_COMPLETED)
            for future in finished:
                bar.update(futures[future].cost)
                yield future.result()
            _show(bar, f"{len(futures) - len(pending)} of {len(futures)} {done}", workers)


def _show(bar: Any, told: str, workers: int) -> None:
    seconds = remaining_seconds(bar.total, bar.n, bar.format_dict["elapsed"], workers)
    bar.set_description_str(told, refresh=False)
    bar.set_postfix_str(f"about {bar.format_interval(seconds)} to go")


def _run(job: Job, processes: Processes) -> Failure | None:
    try:
        return job.work(processes)
    except Stopped:
        return None
