"""Files that are there whole or not at all."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def whole_file(target: Path) -> Iterator[Path]:
    """A temporary name beside `target`, of the same suffix, to write to: renamed at the end, removed after an error.

    Unlike tempfile's, the file gets the permissions that the user's umask gives to any other.
    """
    unfinished = target.with_name(f".{target.stem}.{os.getpid()}.{threading.get_ident()}{target.suffix}")
    try:
        yield unfinished
        os.replace(unfinished, target)
    except OSError as error:
        # A write that fails does not say what was written.
        error.filename = error.filename or str(target)
        raise
    finally:
        unfinished.unlink(missing_ok=True)
