"""How tests wait: for what happens, and at most as long as it never takes, so that no outcome depends on how busy the machine is."""

import os
import signal
import time
from collections.abc import Callable
from pathlib import Path

DEADLINE = 600.0
"""Seconds after which what a test waits for is given up; on a busy machine, and under valgrind, it takes far less."""


def wait_until(happens: Callable[[], object], what: str) -> None:
    """Returns as soon as `happens` returns something true; AssertionError that names what did not happen by the deadline."""
    end = time.monotonic() + DEADLINE
    while not happens():
        assert time.monotonic() < end, f"{what}: not within {DEADLINE:g} s"
        time.sleep(0.05)


def heed_signals() -> None:
    """For processes that a closed terminal or Ctrl-C has to end: what nohup starts ignores the one, what a shell runs in the background the
    other, and so would they.
    """
    for ignored in (signal.SIGHUP, signal.SIGINT):
        signal.signal(ignored, signal.SIG_DFL)


def has_ended(process: int | str) -> bool:
    """Tells whether a process, given by its number, is gone or a zombie."""
    try:
        return not Path(f"/proc/{process}/cmdline").read_bytes()
    except (FileNotFoundError, ProcessLookupError):
        return True


def aged(path: Path) -> int:
    """Puts the last change of a file into the past, so that the next one has another time however coarse the clock is; returns it in ns."""
    os.utime(path, ns=(10**18, 10**18))
    return path.stat().st_mtime_ns


def marked(folder: Path) -> dict[int, str]:
    """Returns the processes, with their command lines, that have this folder, or one within it, for their temporary files: what they
    start has, too."""
    mark = f"TMPDIR={folder}".encode()
    found = {}
    for process in Path("/proc").iterdir():
        try:
            if process.name.isdecimal() and mark in (process / "environ").read_bytes():
                found[int(process.name)] = (process / "cmdline").read_bytes().replace(b"\0", b" ").decode()
        except OSError:
            # It has ended, or is another user's.
            continue
    return found
