"""One stage of one case: what computes an answer, and the file and the key under which the answer is stored; and the child processes of stages, which can all be stopped
at once."""

import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from glob import escape
from pathlib import Path

from analysis.results.store import Document, is_current, write_json
from analysis.results.study_results import Failure
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


class NoAnswer(Exception):
    """Says why a stage has no answer."""


class Refused(NoAnswer):
    """Says why a method cannot answer such a case; the reason is the same for all cases like it."""


@dataclass(frozen=True)
class Stage:
    """Computes an answer and stores it in the file `target` under `key`. A failure is reported under `name` and `case`; the case is
    empty for what belongs to no case. `seconds` is the expected time on one core. `answer` returns the document to store; NoAnswer,
    ValueError and RuntimeError say why there is none."""

    name: str
    case: str
    target: Path
    key: str
    seconds: float
    answer: Callable[[Processes], Document]

    @property
    def is_current(self) -> bool:
        """Whether the answer is stored already, under this very key."""
        return is_current(self.target, self.key)

    def forget(self) -> None:
        """Removes an outdated answer, and the unfinished files that killed writers left beside it."""
        for outdated in (self.target, *self.target.parent.glob(f".{escape(self.target.stem)}.*")):
            outdated.unlink(missing_ok=True)

    def run(self, processes: Processes) -> Failure | None:
        """Computes and stores the answer; returns why there is none."""
        try:
            document = self.answer(processes)
        except (NoAnswer, ValueError, RuntimeError) as error:
            return Failure(self.case, self.name, str(error), isinstance(error, Refused))
        write_json(self.target, {"key": self.key, **document})
        return None


def outdated(stages: Iterable[Stage]) -> list[Stage]:
    """Returns the stages whose answers are missing or stored under another key; such answers are removed."""
    found = [stage for stage in stages if not stage.is_current]
    for stage in found:
        stage.forget()
    return found


def parsed(text: str) -> Document:
    """Parses the JSON document that a program wrote; NoAnswer if it is none."""
    try:
        document = json.loads(text)
    except ValueError as error:
        raise NoAnswer(f"wrote no JSON document: {error}") from error
    if not isinstance(document, dict):
        raise NoAnswer("wrote no JSON document")
    return document


@contextmanager
def unfinished_file(target: Path) -> Iterator[Path]:
    """Gives a hidden file beside `target` for a program to write its answer to, and removes it afterwards."""
    target.parent.mkdir(parents=True, exist_ok=True)
    unfinished = target.with_name(f".{target.name}.unfinished").resolve()
    try:
        yield unfinished
    finally:
        unfinished.unlink(missing_ok=True)
