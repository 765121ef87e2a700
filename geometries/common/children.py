"""Programs and temporary folders that end with the process that made them, in whatever way it ends: SIGKILL leaves nothing behind either."""

from __future__ import annotations

import ctypes
import errno
import os
import shutil
import signal
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

ENDS_WITH_PARENT = ("setpriv", "--pdeathsig", "KILL")
"""Prefix of a command that the kernel is to kill when the thread that started it ends."""
# The parent may have ended before the kernel was told: then the shell, which knows its present parent, starts nothing.
_UNLESS_ORPHANED = '[ "$PPID" = "$0" ] && exec "$@"'
# Of Linux' prctl: the signal that a process gets when its parent ends.
_PR_SET_PDEATHSIG = 1
# Makes a folder, prints its name, and removes it when its standard input ends, which its starter and its forks hold open. What has not
# ended yet may write to the folder for a while.
_FOLDER_KEEPER = """
trap '' HUP INT TERM PIPE
folder=$(mktemp -d -p "${0:-${TMPDIR:-/tmp}}") || exit
echo "$folder"
read -r _
tries=600
until rm -rf -- "$folder" || [ $((tries -= 1)) -eq 0 ]; do sleep 0.1; done
"""
# Runs a program in a process group of its own, and ends all of the group when the standard input ends, which its starter holds open.
_GROUP_KEEPER = """
exec 3<&0 </dev/null
setsid "$@" 3<&- &
group=$!
(read -r _ <&3; kill -s TERM -- "-$group") >/dev/null 2>&1 &
wait "$group"
status=$?
kill $!
exit "$status"
"""


def ending_with_this(command: Sequence[str | os.PathLike[str]]) -> list[str]:
    """Returns the command line by which the calling thread starts a program that is killed when the thread or its process ends.

    What the program itself starts is killed only if it is started in the same way. Raises FileNotFoundError if there is no such program.
    """
    words = [os.fspath(word) for word in command]
    if shutil.which(words[0]) is None:
        raise FileNotFoundError(errno.ENOENT, "there is no such program", words[0])
    return [*ENDS_WITH_PARENT, "sh", "-c", _UNLESS_ORPHANED, str(os.getpid()), *words]


def run_with_all_it_starts(command: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Runs a shell's command in a folder and returns what it prints. It and all that it starts, such as the compilers of a build, are
    told to end (SIGTERM) when this process ends.
    """
    reading, writing = os.pipe()
    try:
        return subprocess.run(
            ["sh", "-c", _GROUP_KEEPER, "sh", "sh", "-c", command],
            cwd=folder,
            stdin=reading,
            capture_output=True,
            text=True,
            check=False,
            start_new_session=True,
        )
    finally:
        os.close(reading)
        os.close(writing)


def end_with(parent: int) -> None:
    """Has the kernel kill this process, a child of `parent`, when that ends; exits if it has ended already."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)


@contextmanager
def temporary_folder(place: Path | None = None) -> Iterator[Path]:
    """Gives a new folder in `place`, or where the system has temporary files; it is removed at the end or when this process ends.

    A process in a session of its own makes and removes the folder, so that a signal to all others leaves it alone. Python's `tempfile`
    would try the place by a file of its own, which stays if this process is killed then.
    """
    with subprocess.Popen(
        ["sh", "-c", _FOLDER_KEEPER, str(place or "")],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as keeper:
        assert keeper.stdout is not None and keeper.stderr is not None
        name = keeper.stdout.readline().removesuffix("\n")
        if not name:
            raise OSError(f"cannot make a temporary folder: {keeper.stderr.read().strip()}")
        yield Path(name)
