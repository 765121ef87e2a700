"""The examples, and the sources of the library for browsers."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.by_night import all_but

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "model" / "examples"
PROGRAMS = sorted([*EXAMPLES.glob("*.cpp"), *EXAMPLES.glob("*.py")])


def header(program: Path) -> str:
    """The comment at the beginning of a program, without the signs that make it one."""
    text = program.read_text(encoding="utf-8")
    if program.suffix == ".py":
        return text.split('"""')[1]
    lines = text.split("\n\n")[0].splitlines()
    return "\n".join(line.removeprefix("//").removeprefix(" ") for line in lines)


# The programs in C++ are built by night.
@pytest.mark.parametrize(
    "program",
    all_but([path for path in PROGRAMS if path.suffix == ".py"], PROGRAMS),
    ids=[path.name for path in PROGRAMS],
)
def test_an_example_prints_what_its_header_says(program: Path) -> None:
    lesson, output = header(program).split("Output:\n")
    run = re.search(r"^Run it: +(.+)$", lesson, re.MULTILINE)
    assert run is not None and "Expect:" in lesson
    command = run[1].removeprefix("PYTHONPATH=build/python ").split()
    command[0] = sys.executable if command[0] == "python3" else str(ROOT / command[0])
    environment = os.environ | {"PYTHONPATH": str(ROOT / "build" / "python")}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True)
    expected = "\n".join(line[2:] for line in output.rstrip().splitlines())
    assert done.stdout == expected + "\n"


def test_the_build_has_every_example() -> None:
    listed = re.search(r"foreach\(example ([^)]+)\)", (EXAMPLES / "CMakeLists.txt").read_text())
    assert listed is not None
    assert listed[1].split() == [program.stem for program in PROGRAMS if program.suffix == ".cpp"]


def test_the_list_has_every_example() -> None:
    listed = re.findall(
        r"^\| `([\w.]+)` \|", (EXAMPLES / "README.md").read_text(encoding="utf-8"), re.MULTILINE
    )
    assert sorted(listed) == sorted(program.name for program in PROGRAMS)


MODEL = Path(__file__).resolve().parents[2] / "model"
SOURCES = [path for folder in ("src", "answers", "browser") for path in (MODEL / folder).rglob("*.?pp")]


def test_its_standard_library_has_every_algorithm_of_ranges_that_is_used() -> None:
    used = {name for path in SOURCES for name in re.findall(r"std::ranges::(\w+)\(", path.read_text())}
    there = set(re.findall(r"^constexpr \w+ (\w+)\(", (MODEL / "browser" / "standard.hpp").read_text(), re.M))
    assert used and used <= there, sorted(used - there)


def test_its_registers_have_every_function_of_those_of_one_number() -> None:
    def functions(file: Path) -> set[str]:
        return set(re.findall(r"^  static [\w:<> ]+ (\w+)\(", file.read_text(), re.M))

    wanted = functions(MODEL / "src" / "simd" / "lanes_scalar.hpp")
    there = functions(MODEL / "browser" / "lanes_simd128.hpp")
    assert wanted and wanted <= there, sorted(wanted - there)
