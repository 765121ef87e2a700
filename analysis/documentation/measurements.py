"""Replaces the measured tables of model/MEASUREMENTS.md: python3 -m analysis measure benchmarks.

A table stands between the comments `<!-- table N of PROGRAM -->` and `<!-- end -->`: it is the
N-th table of what the program measures. The programs take some minutes and should run alone."""

import argparse
import math
import re
import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path

from geometries.common.children import ending_with_this, temporary_folder
from geometries.common.installation import ROOT
from geometries.studies import study

PAGE = ROOT / "model" / "MEASUREMENTS.md"
_TABLE = re.compile(r"(<!-- table (\d+) of (\S+) -->\n).*?(<!-- end -->)", re.DOTALL)
_REDUCED = "build/bin/reduced_benchmark"
_GROUP = re.compile(
    r"^(\S.*): (\d+) set-ups, .* integral takes ([\d.]+) µs in the mean\n((?:  .*\n)+)", re.MULTILINE
)
_ACCURACIES = re.compile(
    r"reduced, rtol ([\d.e-]+): error % median ([\d.]+), worst ([\d.]+); reached (\d+), worst ([\d.]+); covered (\d+); "
    r"µs mean ([\d.]+), median ([\d.]+), longest ([\d.]+)"
)
# The scene files and the two kinds of random poses are in the first table, the bodies of triangles in the second.
_GROUPS_OF_FUNCTIONS = 3


def output_of(program: str) -> str:
    """Runs a program of the build and returns the tables of what it measures."""
    if program != _REDUCED:
        return _printed(program)
    with temporary_folder() as folder:
        scenes = []
        for case in study.load(study.find("default")).cases():
            if case.family == study.EMPTY:
                continue
            scenes.append(folder / f"{case.id}.toml")
            scenes[-1].write_text(case.text, encoding="utf-8")
        return reduced_tables(_printed(program, *scenes))


def _printed(program: str, *arguments: Path) -> str:
    command = ending_with_this([ROOT / program, *arguments])
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def reduced_tables(printed: str) -> str:
    """Makes tables of the lines that reduced_benchmark prints."""
    groups = _GROUP.findall(printed)
    parts = groups[:_GROUPS_OF_FUNCTIONS], groups[_GROUPS_OF_FUNCTIONS:]
    return "\n".join(_table(part) for part in parts)


def _table(groups: list[tuple[str, str, str, str]]) -> str:
    titles = "| | rtol | error %, median / worst | where reached | µs, mean / median / longest |"
    lines = [titles, "|---|---|---|---|---|"]
    for name, count, integral, accuracies in groups:
        what = f"{count} set-ups of the default study" if name == "scene files" else f"{name}, {count}"
        what += f" (the triangle integral: {_time(integral)} µs)"
        for number, found in enumerate(_ACCURACIES.findall(accuracies)):
            rtol, median, worst, reached, worst_reached, covered, *times = found
            if covered != count:
                within = f"{covered} of {count} within the stated errors"
                raise ValueError(f"{name}, reduced, rtol {rtol}: {within}")
            reaching = f"{reached}: {_error(worst_reached)}" if int(reached) else "0"
            errors, taken = f"{_error(median)} / {_error(worst)}", " / ".join(map(_time, times))
            lines.append(f"| {'' if number else what} | {rtol} | {errors} | {reaching} | {taken} |")
    return "\n".join(lines) + "\n"


def _error(text: str) -> str:
    """Writes per cents with two significant digits."""
    value = float(text)
    return f"{value:.{max(0, 1 - math.floor(math.log10(value)))}f}" if value > 0 else "0"


def _time(text: str) -> str:
    """Writes microseconds with two significant digits, or all before the point."""
    value = float(text)
    return f"{value:.0f}" if value >= 10 else f"{value:.1f}"


def tables(text: str) -> list[str]:
    """Returns the tables in a text, each with all its lines."""
    return re.findall(r"(?:^\|.*\n)+", text, re.MULTILINE)


def updated(page: str, measured: Callable[[str], str] = output_of) -> str:
    """Returns the page with the tables that the programs measure now; each program runs once."""
    once = cache(measured)
    return _TABLE.sub(lambda found: found[1] + tables(once(found[3]))[int(found[2]) - 1] + found[4], page)


def measure(_: argparse.Namespace) -> None:
    """Runs the benchmarks and replaces the tables."""
    PAGE.write_text(updated(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
