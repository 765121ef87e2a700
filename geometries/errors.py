"""The error for input that cannot be used."""

from __future__ import annotations


class InputError(ValueError):
    """Wrong input, told as FILE: KEY: REASON, or FILE:LINE: KEY: REASON where the parser knows the line.

    `file` and `key` are empty where there is none, for instance in a family called from Python.
    """

    def __init__(self, file: str, key: str, reason: str, line: int | None = None) -> None:
        self.file = file
        self.key = key
        self.reason = reason
        self.line = line
        place = f"{file}:{line}" if line is not None else file
        super().__init__(": ".join(part for part in (place, key, reason) if part))
