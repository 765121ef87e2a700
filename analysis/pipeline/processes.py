"""Child processes that can all be stopped at once."""

from __future__ import annotations

import os
import signal
import subprocess
import threading
from dataclasses import dataclass
from pathlib import Path

# Before a command: however the process that starts it ends, the command does not outlive it.
ENDS_WITH_US = ("setpriv", "--pdeathsig", "KILL")


@dataclass(frozen=True)
class Finished:
    """What a command left behind. A negative exit code is the signal that ended it."""

    exit_code: int
    output: str
    errors: str


class Stopped(Exception):
    """The processes were told to stop; nothing more is started."""


class Processes:
    """Runs commands from several threads; `stop` ends those that run, with their own children, and starts no more."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._running: set[subprocess.Popen[str]] = set()
        self._stopped = False

    def run(self, command: list[str], folder: Path, environment: dict[str, str]) -> Finished:
        """Run a command in a folder to its end. Raises Stopped when `stop` was called before or meanwhile."""
        with self._lock:
            if self._stopped:
                raise Stopped
            # A session of its own: a Ctrl-C at the terminal reaches this process alone, which then stops its children.
            process = subprocess.Popen(
                [*ENDS_WITH_US, *command],
                cwd=folder,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                start_new_session=True,
            )
            self._running.add(process)
        output, errors = process.communicate()
        with self._lock:
            self._running.discard(process)
            if self._stopped:
                raise Stopped
        return Finished(process.returncode, output, errors)

    def stop(self) -> None:
        """Kill every running command and its children."""
        with self._lock:
            self._stopped = True
            for process in self._running:
                try:
                    os.killpg(process.pid, signal.SIGKILL)
                except ProcessLookupError:
                    pass
