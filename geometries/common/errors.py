"""The error for input that cannot be used."""

from __future__ import annotations


# Room for the longest path that the system knows, and for what is said of it.
_LONGEST = 6000


def _one_line(text: str) -> str:
    half = _LONGEST // 2
    short = text if len(text) <= _LONGEST else f"{text[:half]} … {text[-half:]}"
    return "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in short)


class InputError(ValueError):
    """Wrong input, told as FILE: KEY: REASON, or FILE:LINE: KEY: REASON where the parser knows the line.

    `file` and `key` are empty where there is none, for instance in a family called from Python. The message is one line,
    whatever it names: characters that control a terminal are written out, and the middle of what is too long to be read is left
    out.
    """

    def __init__(self, file: str, key: str, reason: str, line: int | None = None) -> None:
        self.file = file
        self.key = key
        self.reason = reason
        self.line = line
        place = f"{file}:{line}" if line is not None else file
        super().__init__(_one_line(": ".join(part for part in (place, key, reason) if part)))
