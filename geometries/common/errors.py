"""The error for input that cannot be used."""

from __future__ import annotations


# Longest message: room for the longest path of the system, and for the reason.
_LONGEST = 6000


def _one_line(text: str) -> str:
    half = _LONGEST // 2
    short = text if len(text) <= _LONGEST else f"{text[:half]} … {text[-half:]}"
    return "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in short)


class InputError(ValueError):
    """Wrong input. The message is FILE: KEY: REASON, or FILE:LINE: KEY: REASON if the parser knows the line.

    `file` and `key` may be empty, for instance in a family called from Python. The message is always one line: control characters
    are escaped, and the middle of very long texts is left out.
    """

    def __init__(self, file: str, key: str, reason: str, line: int | None = None) -> None:
        self.file = file
        self.key = key
        self.reason = reason
        self.line = line
        place = f"{file}:{line}" if line is not None else file
        super().__init__(_one_line(": ".join(part for part in (place, key, reason) if part)))
