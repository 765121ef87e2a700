"""Child processes that can all be stopped at once."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from dataclasses import dataclass
from pathlib import Path

from geometries.common.children import ending_with_this
from geometries.common.installation import ROOT, cache_folder

_LONGEST_REASON = 300


@dataclass(frozen=True)
class Finished:
    """The result of a command. A negative exit code is the signal that ended it."""

    exit_code: int
    output: str
    errors: str

    @property
    def last_line(self) -> str:
        """The last line that the command wrote to its standard error; empty if it wrote none."""
        lines = [line.strip() for line in self.errors.splitlines() if line.strip()]
        return lines[-1] if lines else ""

    @property
    def reason(self) -> str:
        """Why the command failed: its exit code and its last line."""
        return f"exit code {self.exit_code}: {self.last_line[:_LONGEST_REASON] or 'no message'}"


def environment_of_modules() -> dict[str, str]:
    """Returns the environment in which a process finds the project's Python modules."""
    path = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH", "")]))
    return os.environ | {"PYTHONPATH": path}


class Stopped(Exception):
    """The processes were told to stop; nothing more is started."""


class Processes:
    """Runs commands from several threads; `stop` ends those that run, with their own children, and starts no more."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._running: set[subprocess.Popen[str]] = set()
        self._stopped = False

    def run(self, command: list[str], folder: Path, environment: dict[str, str]) -> Finished:
        """Runs a command in a folder to its end. Raises Stopped when `stop` was called before or meanwhile."""
        with self._lock:
            if self._stopped:
                raise Stopped
            # In a session of its own: a Ctrl-C at the terminal reaches this process only, which then stops its children.
            process = subprocess.Popen(
                ending_with_this(command),
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

    def run_module(self, module: str, *arguments: str) -> Finished:
        """Runs one of the project's Python modules to its end, on one core."""
        environment = environment_of_modules() | {
            "OMP_NUM_THREADS": "1",
            # The forms that the field solver compiles are kept for the next process.
            "XDG_CACHE_HOME": str(cache_folder()),
        }
        # -P: a folder of the same name where the user stands must not be taken for the module.
        return self.run([sys.executable, "-P", "-m", module, *arguments], ROOT, environment)

    def refuse_to_go_on(self) -> None:
        """Raises Stopped after `stop`."""
        if self._stopped:
            raise Stopped

    def stop(self) -> None:
        """Kills every running command and its children."""
        with self._lock:
            self._stopped = True
            for process in self._running:
                try:
                    os.killpg(process.pid, signal.SIGKILL)
                except ProcessLookupError:
                    pass


def forget_unfinished_forms(cache: Path | None = None) -> None:
    """Removes the marks of compilations that were killed: FFCx would wait for them in vain, in every later process."""
    for source in ((cache or cache_folder()) / "fenics").glob("libffcx_*.c"):
        if not source.with_name(f"{source.name}.cached").exists():
            source.unlink(missing_ok=True)
