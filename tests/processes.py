"""What is left of processes that a test started."""

from __future__ import annotations

from pathlib import Path


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
