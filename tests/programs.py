"""The project's programs as users start them, from the build."""

import os
import pty
import subprocess
import threading
from contextlib import suppress
from pathlib import Path

from tests.waiting import DEADLINE

ROOT = Path(__file__).resolve().parents[1]
FRINGE = ROOT / "build" / "bin" / "fringe"


def fringe_command(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Runs the command `fringe` with the given arguments and returns what came of it."""
    command = [str(FRINGE), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=DEADLINE)


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
