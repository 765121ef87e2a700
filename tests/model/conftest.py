"""Where the tests of the model find what the build made."""

import os
import pty
import subprocess
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest

from tests import scenes
from tests.waiting import DEADLINE

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "build" / "python"))

Command = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture(scope="session")
def fringe_command() -> Command:
    """Runs build/bin/fringe with the given arguments and returns what came of it."""

    def run(*arguments: str | Path) -> "subprocess.CompletedProcess[str]":
        command = [str(ROOT / "build" / "bin" / "fringe"), *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, check=False, timeout=DEADLINE)

    return run


@pytest.fixture(scope="session")
def shown_on_a_terminal() -> Callable[..., str]:
    """Runs build/bin/fringe, which must print an answer, and returns what it shows on the terminal that its errors go to."""

    def run(*arguments: str | Path) -> str:
        command = [str(ROOT / "build" / "bin" / "fringe"), *map(str, arguments)]
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

    return run


@pytest.fixture(scope="session")
def sensor_before_a_housing() -> str:
    """A scene whose grounded box nearly takes up the charge of the sensor before it, as seen from afar."""
    return scenes.SENSOR + scenes.body("housing", "cuboid", size=[0.2, 0.2, 0.1], translation=[0, 0, -0.06])
