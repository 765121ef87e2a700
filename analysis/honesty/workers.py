"""A process that asks the model's module, so that what ends it, or does not end, ends no run."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any

from analysis.honesty.asking import ask
from analysis.honesty.methods import ENDED, LATE, Answer
from analysis.pipeline.model_stage import model_module
from geometries.common.children import end_with

_WAITING, _GRACE = 10.0, 60.0
"""How many times the limit of processor time an answer may take by the clock, and seconds more within which the library has to notice it."""
_STARTING = 60.0
"""Seconds that a process may take to start."""
_PATIENCE = 0.2
"""Seconds after which the waiting thread looks whether it is to stop."""


class Worker:
    """One process at a time, started when it is first asked, and anew after it has ended; a context manager."""

    def __init__(self) -> None:
        self._process: Any = None
        self._pipe: Connection | None = None

    def __enter__(self) -> Worker:
        return self

    def __exit__(self, *_: object) -> None:
        self.end()

    def ask(
        self,
        text: str,
        has_readings: bool,
        options: dict[str, Any],
        seconds: float,
        go_on: Callable[[], None],
    ) -> Answer:
        """Returns the answer of `asking.ask`, or how the process ended; `go_on` raises when the run is to stop."""
        pipe = self._started()
        begin = time.monotonic()
        try:
            pipe.send((text, has_readings, options, seconds))
            while time.monotonic() - begin < _WAITING * seconds + _GRACE:
                if pipe.poll(_PATIENCE):
                    answer: Answer = pipe.recv()
                    return answer
                go_on()
            self.end()
            return Answer(LATE, time.monotonic() - begin, "does not notice the limit of time")
        except (EOFError, OSError):
            self._process.join()
            code = self._process.exitcode
            self.end()
            how = f"signal {-code} ({signal.strsignal(-code)})" if code < 0 else f"status {code}"
            return Answer(ENDED, time.monotonic() - begin, f"the process ended by {how}")
        except BaseException:
            self.end()
            raise

    def end(self) -> None:
        """Ends the process, if there is one."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
        if self._pipe is not None:
            self._pipe.close()
        self._process = self._pipe = None

    def _started(self) -> Connection:
        if self._pipe is None:
            context = multiprocessing.get_context("spawn")
            self._pipe, other = context.Pipe()
            self._process = context.Process(target=_serve, args=(other, os.getpid()), daemon=True)
            with _STARTS:
                self._process.start()
            other.close()
            # The first message says that the modules are loaded.
            if not self._pipe.poll(_STARTING):
                raise OSError("a process does not start")
            self._pipe.recv()
        return self._pipe


_STARTS = threading.Lock()
"""Processes are started one after the other: their ends of pipes must not be inherited by others."""


def _serve(pipe: Connection, parent: int) -> None:
    """Answers until the pipe ends."""
    end_with(parent)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    model_module()
    pipe.send(None)
    while True:
        try:
            asked = pipe.recv()
        except EOFError:
            return
        pipe.send(ask(*asked))
