"""Reads the text of mesh files, and its numbers: decimal and finite, without the other forms that Python accepts."""

from __future__ import annotations

import codecs
import re
from collections.abc import Iterable

import numpy as np

from geometries.common.arrays import Array

_DECIMAL = re.compile(rb"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_WHOLE = re.compile(rb"[+-]?\d{1,18}")
_DIGIT = re.compile(rb"[1-9]")


class Damaged(Exception):
    """A mesh file is not what its format asks for; the message says where and why."""


def plain_text(content: bytes) -> bytes:
    """Returns a text in UTF-8 without a byte order mark, whose lines end in a line feed; it may be in UTF-16, or have carriage returns only."""
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        try:
            content = content.decode("utf-16").encode()
        except UnicodeError as error:
            raise Damaged("is damaged text in UTF-16") from error
    content = content.removeprefix(codecs.BOM_UTF8)
    return content if b"\n" in content else content.replace(b"\r", b"\n")


def shown(word: bytes) -> str:
    """Returns a word of a file in the form that messages show."""
    text = word[:40].decode("ascii", "backslashreplace")
    return repr(text + "…" if len(word) > 40 else text)


def decimals(words: Iterable[bytes]) -> Array:
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
