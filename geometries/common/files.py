"""Writes files so that readers find a whole file or none."""

from __future__ import annotations

import os
import platform
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


@contextmanager
def whole_file(target: Path) -> Iterator[Path]:
    """Gives a temporary file beside `target`, with the same suffix, to write to; it is renamed at the end, or removed after an error.

    Files left by killed writers of the same target on this machine are removed, too. Unlike tempfile's, the file has the permissions
    that the user's umask gives to any other.
    """
    head = f".{target.stem}.{platform.node()}."
    unfinished = target.with_name(f"{head}{os.getpid()}.{threading.get_ident()}{target.suffix}")
    with suppress(OSError):
        _remove_left(target.parent, head, target.suffix)
    try:
        yield unfinished
        os.replace(unfinished, target)
    except OSError as error:
        # The error of a failed write names no file, others the temporary one.
        if error.filename in (None, str(unfinished)):
            error.filename = str(target)
            del error.filename2
        raise
    finally:
        unfinished.unlink(missing_ok=True)


def _remove_left(folder: Path, head: str, suffix: str) -> None:
    for name in os.listdir(folder):
        if name.startswith(head) and name.endswith(suffix):
            process = name.removeprefix(head).partition(".")[0]
            if process.isdecimal() and not _is_running(int(process)):
                (folder / name).unlink(missing_ok=True)


def _is_running(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True
