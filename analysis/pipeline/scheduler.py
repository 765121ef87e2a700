"""Runs jobs in parallel, as many as cores and memory allow, with a progress bar that shows the remaining time."""

import os
import signal
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import AbstractContextManager, contextmanager
from typing import Any, Protocol

import psutil
from tqdm import tqdm

from analysis.pipeline.model_stage import asking
from analysis.pipeline.stage import Processes, Stopped, forget_unfinished_forms
from analysis.results.study_results import Failure

# Memory (bytes) of one solve of the reference at its finest level, with room to spare.
_MEMORY_PER_JOB = 3 * 2**30
_REFRESH_SECONDS = 1.0


class Job(Protocol):
    """Work that takes about `seconds` on one core. `run` returns a failure or None; a Stage is a Job."""

    @property
    def seconds(self) -> float:
        ...

    def run(self, processes: Processes) -> Failure | None:
        ...


def parallel_jobs() -> int:
    """Returns how many jobs fit on this machine, by its cores and its free memory."""
    cores = len(os.sched_getaffinity(0))
    return max(1, min(cores, int(psutil.virtual_memory().available) // _MEMORY_PER_JOB))


def run_all(jobs: Sequence[Job], workers: int, done: str = "solved", shown: bool = True) -> list[Failure]:
    """Runs the jobs, the costly ones first so that none is left over at the end; returns the failures.

    `done` is the progress bar's word for finished jobs; without `shown` there is no bar.

    KeyboardInterrupt ends the running jobs' processes and what they compute by the model's module, starts no more, and is raised again.
    """
    if not jobs:
        return []
    processes = Processes()
    ordered = sorted(jobs, key=lambda job: -job.seconds)
    with ThreadPoolExecutor(workers) as pool:
        try:
            futures = {pool.submit(_run, job, processes): job for job in ordered}
            return [failure for failure in _watch(futures, workers, done, shown) if failure is not None]
        except BaseException:
            processes.stop()
            pool.shutdown(cancel_futures=True)
            forget_unfinished_forms()
            raise


@contextmanager
def _undisturbed() -> Iterator[None]:
    """Delays signals: a progress bar that is interrupted while it is constructed complains when it is deleted."""
    blocked = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, blocked)


def remaining_seconds(total: float, done: float, elapsed: float, workers: int) -> float:
    """Estimates the remaining time from the pace so far; before the first job has ended, from the expected seconds."""
    if done == 0:
        return max(0.0, total / workers - elapsed)
    return elapsed * (total - done) / done


class Progress(AbstractContextManager["Progress"]):
    """A bar that counts expected cost rather than jobs, with the time that is left; a context manager."""

    def __init__(
        self, total: float, count: int, workers: int, done: str = "solved", shown: bool = True
    ) -> None:
        layout = "{desc} {bar} {percentage:3.0f} %, {elapsed} gone{postfix}"
        with _undisturbed():
            self._bar: Any = tqdm(total=total, bar_format=layout, ncols=100, disable=not shown)
        self._count, self._workers, self._done, self._shown = count, workers, done, shown
        self.tell(0)

    def __exit__(self, *_: object) -> None:
        self._bar.close()

    def advance(self, cost: float) -> None:
        # Rounding may make the sum of the parts exceed the total.
        self._bar.update(min(cost, self._bar.total - self._bar.n))

    def tell(self, ended: int) -> None:
        """Shows how many jobs have ended."""
        if not self._shown:
            return
        bar = self._bar
        seconds = remaining_seconds(bar.total, bar.n, bar.format_dict["elapsed"], self._workers)
        bar.set_description_str(f"{ended} of {self._count} {self._done}", refresh=False)
        bar.set_postfix_str(f"about {bar.format_interval(seconds)} to go")


def _watch(
    futures: dict[Future[Failure | None], Job], workers: int, done: str, shown: bool
) -> Iterator[Failure | None]:
    """Returns the jobs' outcomes as they come, with a progress bar."""
    total, pending = sum(job.seconds for job in futures.values()), set(futures)
    # A terminal shows the time running; a log gets a line for each finished job only.
    patience = _REFRESH_SECONDS if sys.stderr.isatty() else None
    with Progress(total, len(futures), workers, done, shown) as progress:
        while pending:
            finished, pending = wait(pending, patience, FIRST_COMPLETED)
            for future in finished:
                progress.advance(futures[future].seconds)
                yield future.result()
            progress.tell(len(futures) - len(pending))


def _run(job: Job, processes: Processes) -> Failure | None:
    try:
        # Python handles Ctrl-C on the main thread only; this one asks whether it has come.
        with asking(processes.refuse_to_go_on):
            return job.run(processes)
    except Stopped:
        return None
