"""The project's programs as users start them, from the build."""

import io
import os
import pty
import subprocess
import threading
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout, suppress
from pathlib import Path

from tests.waiting import DEADLINE

ROOT = Path(__file__).resolve().parents[1]
FRINGE = ROOT / "build" / "bin" / "fringe"


def fringe_command(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Runs the command `fringe` with the given arguments and returns what came of it."""
    command = [str(FRINGE), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=DEADLINE)


def in_this_process(main: Callable[[list[str]], int], *arguments: object) -> subprocess.CompletedProcess[str]:
    """Returns what came of a package's command in this process, which loads its modules once for all tests."""
    words, out, err = list(map(str, arguments)), io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        try:
            status = main(words)
        except SystemExit as ended:
            status = int(ended.code or 0)
    return subprocess.CompletedProcess(words, status, out.getvalue(), err.getvalue())


def analysis(*arguments: object, status: int = 0) -> subprocess.CompletedProcess[str]:
    """Returns what came of the command of the package `analysis` in this process; it has to end with this status."""
    # Loading it takes longer than many a test of other packages.
    from analysis.__main__ import main

    done = in_this_process(main, *arguments)
    assert done.returncode == status, done.stderr
    return done


def shown_on_a_terminal(*arguments: str | Path) -> str:
    """Runs the command `fringe`, which must print an answer, and returns what it shows on the terminal that its errors go to."""
    command = [str(FRINGE), *map(str, arguments)]
    terminal, end = pty.openpty()
    parts: list[bytes] = []

    def read() -> None:
        # A terminal hands over a part at a time, and fails once the program has left it.
        with suppress(OSError):
            while part := os.read(terminal, 4096):
                parts.append(part)

    # Read meanwhile: a terminal holds so much, and a program that shows more waits.
    reader = threading.Thread(target=read)
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=end) as process:
        os.close(end)
        reader.start()
        answer, _ = process.communicate(timeout=DEADLINE)
    reader.join()
    os.close(terminal)
    assert answer and process.returncode in (0, 3)
    return b"".join(parts).decode()
