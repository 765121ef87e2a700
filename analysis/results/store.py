"""Stores answers as JSON documents. A reader finds a whole document or none."""

import csv
import fcntl
import io
import json
import math
import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from geometries.common.errors import InputError
from geometries.common.files import whole_file

Document = dict[str, Any]

_FRONT = b'{\n "key": "'


def write_text(path: Path, text: str) -> None:
    """Writes a file, whole or not at all; its folder is made when missing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with whole_file(path) as unfinished:
        unfinished.write_text(text, encoding="utf-8")


def finite(number: float) -> float | None:
    """Returns a number as JSON can express it: None if it is not finite."""
    return number if math.isfinite(number) else None


def csv_text(header: Iterable[object], rows: Iterable[Iterable[object]]) -> str:
    """Returns rows below a header as CSV; None is empty."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([header, *rows])
    return text.getvalue()


def markdown_table(header: Sequence[str], rows: Iterable[Iterable[object]]) -> list[str]:
    """Returns the lines of a table as notes have it."""
    return [f"| {' | '.join(map(str, cells))} |" for cells in (header, ["---"] * len(header), *rows)]


def refuse_unwritable(path: Path) -> None:
    """Raises InputError if a file cannot be written, before anything is computed for it."""
    folder = next(parent for parent in path.absolute().parents if parent.exists())
    if path.is_dir() or not folder.is_dir() or not os.access(folder, os.W_OK):
        raise InputError(str(path), "", "is a folder, or in one that cannot be written to")


def write_json(path: Path, document: Document) -> None:
    """Writes a JSON document, whole or not at all; NumPy arrays in it are written as lists."""
    write_text(path, json.dumps(document, indent=1, default=np.ndarray.tolist) + "\n")


def read_json(path: Path) -> Document | None:
    """Returns the JSON document in a file; None when there is none."""
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return document if isinstance(document, dict) else None


def read_current(path: Path, key: str) -> Document | None:
    """Returns the document in a file when it was stored under this very key; None when it must be computed."""
    document = read_json(path)
    return document if document is not None and document.get("key") == key else None


def is_current(path: Path, key: str) -> bool:
    """Tells whether `read_current` would find a document. The document is not parsed if
    the key comes first in it, as in every document that this program writes."""
    try:
        content = path.read_bytes()
    except OSError:
        return False
    if not content.startswith(_FRONT):
        return read_current(path, key) is not None
    return content.startswith(_FRONT + key.encode() + b'"') and content.endswith(b"}\n")


class InUse(Exception):
    """Another process is at work in the folder."""


@contextmanager
def exclusive(folder: Path) -> Iterator[None]:
    """Locks a folder against other processes that use this lock. The operating system releases it when this process ends, however
    it ends. Raises InUse at once if another process holds it."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / ".lock").open("a") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise InUse(f"{folder} is in use by another run") from error
        yield
