"""Runs the command in a process of its own, which can be ended at any time, also inside the mesher and the linear solver.

What the command has reported so far is kept, so that Ctrl-C and a limit of time end with the last answer.
"""

from __future__ import annotations

import math
import os
import signal
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing import Pipe
from multiprocessing.connection import Connection, wait

from geometries.common.children import end_with, temporary_folder

MOST_STATUS = 3
"""The largest status that the command itself returns; libraries abort with others."""
INTERRUPTED = 130
"""What shells report for a command that was interrupted."""
# Variable in which mpirun tells a process its number.
_NUMBER = "OMPI_COMM_WORLD_RANK"


@dataclass(frozen=True)
class AnswerSoFar:
    """An answer that is less accurate than asked for: its text for standard output, a message, and the time (s) that is left for a
    better one."""

    text: str
    message: str
    seconds_left: float
    is_answer: bool = True
    """False before the first answer: `text` and `message` then say that the time was too short for one."""


Report = Callable[[AnswerSoFar], None]


def supervised(command: Callable[[Report], int], unreached: int) -> int:
    """Runs `command` in a child process, in which it returns its exit status; returns that of this process.

    The command reports answers so far. After the time that the last one leaves, or if the system ends the command, this process prints it
    and returns `unreached`; after Ctrl-C it prints it and returns INTERRUPTED. Under mpirun each process has such a parent. If one of them
    ends, mpirun ends the others by SIGTERM, upon which the first one prints the answer.
    """
    receiving, sending = Pipe(duplex=False)
    wakes = _wakes_on_interrupt()
    sys.stdout.flush()
    parent = os.getpid()
    with temporary_folder() as folder:
        child = os.fork()
        if child == 0:
            end_with(parent)
            # The parent decides. The handler stays: programs that the command starts would inherit SIG_IGN.
            signal.set_wakeup_fd(-1)
            signal.signal(signal.SIGTERM, signal.SIG_DFL)
            receiving.close()
            # MPI and compilers leave files when they are killed.
            os.environ["TMPDIR"] = str(folder)
            if _NUMBER not in os.environ:
                # Without mpirun a daemon of Open MPI outlives the command by a moment, and would complain that its shared files are gone.
                os.environ.setdefault("PMIX_MCA_gds", "hash")
            return command(sending.send)
        sending.close()
        return _watched(child, receiving, wakes, unreached)


def _watched(child: int, reports: Connection, wakes: int, unreached: int) -> int:
    latest: AnswerSoFar | None = None
    ends = math.inf
    interrupted = False
    while True:
        ready = wait([reports, wakes], None if math.isinf(ends) else max(0.0, ends - time.monotonic()))
        interrupted = wakes in ready
        if interrupted or not ready:
            os.kill(child, signal.SIGKILL)
            latest = _last(reports) or latest
            break
        try:
            so_far: AnswerSoFar = reports.recv()
        except EOFError:
            break
        latest, ends = so_far, time.monotonic() + so_far.seconds_left
    _, state = os.waitpid(child, 0)
    status = os.waitstatus_to_exitcode(state)
    is_first = int(os.environ.get(_NUMBER, "0")) == 0
    if interrupted:
        if is_first:
            print("", file=sys.stderr)
    elif 0 <= status <= MOST_STATUS or status > 0 and (latest is None or not latest.is_answer):
        return status
    out_of_time = not interrupted and status == -signal.SIGKILL and time.monotonic() >= ends
    if latest is not None and (out_of_time or latest.is_answer):
        if latest.text:
            print(latest.text, flush=True)
        if latest.message:
            print(latest.message, file=sys.stderr)
        if not (out_of_time or interrupted):
            print(f"fem_reference: {_ended_by(status)}", file=sys.stderr)
        return INTERRUPTED if interrupted else unreached
    if interrupted:
        if is_first:
            print("fem_reference: interrupted before the first answer", file=sys.stderr)
        return INTERRUPTED
    print(f"fem_reference: {_ended_by(status)}", file=sys.stderr)
    # As a shell reports it.
    return 128 - status


def _ended_by(status: int) -> str:
    """Says what ended the command from outside; the system does for want of memory."""
    if status > 0:
        return f"aborted by a library with status {status}, as for want of memory"
    name = signal.Signals(-status).name
    return (
        f"ended by {name}, as the system does for want of memory"
        if status == -signal.SIGKILL
        else f"ended by {name}"
    )


def _wakes_on_interrupt() -> int:
    """Returns a file descriptor that can be read after Ctrl-C and, under mpirun, SIGTERM. An exception could come while a report is received, and lose it."""
    wakes, woken = os.pipe()
    os.set_blocking(woken, False)
    signal.set_wakeup_fd(woken)
    signal.signal(signal.SIGINT, lambda *_: None)
    if _NUMBER in os.environ:
        signal.signal(signal.SIGTERM, lambda *_: None)
    return wakes


def _last(reports: Connection) -> AnswerSoFar | None:
    """Returns the last report of a child that has ended, if one has not been received yet."""
    latest: AnswerSoFar | None = None
    try:
        while True:
            latest = reports.recv()
    except EOFError:
        return latest
