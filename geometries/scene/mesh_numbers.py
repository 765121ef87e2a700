"""Reads numbers of text mesh files: decimal and finite, without the other forms that Python accepts."""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

_DECIMAL = re.compile(rb"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_WHOLE = re.compile(rb"[+-]?\d{1,18}")
_DIGIT = re.compile(rb"[1-9]")


class Damaged(Exception):
    """A mesh file is not what its format asks for; the message says where and why."""


def shown(word: bytes) -> str:
    """Returns a word of a file in the form that messages show."""
    text = word[:40].decode("ascii", "backslashreplace")
    return repr(text + "…" if len(word) > 40 else text)


def decimals(words: Iterable[bytes]) -> NDArray[np.float64]:
    """Converts words to numbers."""
    return np.fromiter(map(_decimal, words), dtype=np.float64)


def whole(word: bytes) -> int:
    if _WHOLE.fullmatch(word) is None:
        raise Damaged(f"holds {shown(word)} instead of an integer")
    return int(word)


def _decimal(word: bytes) -> float:
    if _DECIMAL.fullmatch(word) is None:
        raise Damaged(f"holds {shown(word)} instead of a finite number")
    value = float(word)
    if abs(value) == np.inf or (value == 0 and _DIGIT.search(re.split(rb"[eE]", word)[0])):
        raise Damaged(f"holds {shown(word)}, which is beyond the range of numbers")
    return value
