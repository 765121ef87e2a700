"""Stored answers: documents that are there whole or not at all."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from geometries.files import whole_file

Document = dict[str, Any]


def write_text(path: Path, text: str) -> None:
    """Write a file, whole or not at all; its folder is made when missing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with whole_file(path) as unfinished:
        unfinished.write_text(text, encoding="utf-8")


def write_json(path: Path, document: Document) -> None:
    """Write a JSON document, whole or not at all."""
    write_text(path, json.dumps(document, indent=1) + "\n")


def read_json(path: Path) -> Document | None:
    """The JSON document in a file; None when there is none."""
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return document if isinstance(document, dict) else None


def read_current(path: Path, key: str) -> Document | None:
    """The document in a file when it was stored under this very key; None when it must be computed."""
    document = read_json(path)
    return document if document is not None and document.get("key") == key else None
