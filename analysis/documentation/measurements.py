"""Replaces the measured tables of model/MEASUREMENTS.md: python3 -m analysis.documentation.measurements.

A table stands between the comments `<!-- table N of PROGRAM -->` and `<!-- end -->`: it is the N-th table that the program prints. The
programs take minutes and should run alone.
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from functools import cache

from analysis.pipeline.keys import REPOSITORY

PAGE = REPOSITORY / "model" / "MEASUREMENTS.md"
_TABLE = re.compile(r"(<!-- table (\d+) of (\S+) -->\n).*?(<!-- end -->)", re.DOTALL)


def output_of(program: str) -> str:
    """What a program of the build prints."""
    return subprocess.run([REPOSITORY / program], capture_output=True, text=True, check=True).stdout


def tables(text: str) -> list[str]:
    """The tables in a text, each with all its lines."""
    return re.findall(r"(?:^\|.*\n)+", text, re.MULTILINE)


def updated(page: str, printed: Callable[[str], str] = output_of) -> str:
    """The page with the tables that the programs print now; each program runs once."""
    once = cache(printed)
    return _TABLE.sub(lambda found: found[1] + tables(once(found[3]))[int(found[2]) - 1] + found[4], page)


if __name__ == "__main__":
    PAGE.write_text(updated(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
