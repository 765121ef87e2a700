"""The numbers of mesh files of text: decimal, finite, and nothing else that Python would take for one."""

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
    """Returns a word of a file as a message may show it."""
    text = word[:40].decode("ascii", "backslashreplace")
    return repr(text + "…" if len(word) > 40 else text)


def decimals(words: Iterable[bytes]) -> NDArray[np.float64]:
    """Returns the numbers that the words stand for."""
    return np.fromiter(map(_decimal, words), dtype=np.float64)


def whole(word: bytes) -> int:
    if _WHOLE.fullmatch(word) is None:
        raise Damaged(f"holds {shown(word)} in the place of a whole number")
    return int(word)


def _decimal(word: bytes) -> float:
    if _DECIMAL.fullmatch(word) is None:
        raise Damaged(f"holds {shown(word)} in the place of a finite number")
    value = float(word)
    if abs(value) == np.inf or (value == 0 and _DIGIT.search(re.split(rb"[eE]", word)[0])):
        raise Damaged(f"holds {shown(word)}, which is beyond the range of numbers")
    return value
