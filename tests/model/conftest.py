"""Where the tests of the model find what the build made."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "build" / "python"))

Command = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture(scope="session")
def fringe_command() -> Command:
    """Runs build/bin/fringe with the given arguments and returns what came of it."""

    def run(*arguments: str | Path) -> "subprocess.CompletedProcess[str]":
        command = [str(ROOT / "build" / "bin" / "fringe"), *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)

    return run
