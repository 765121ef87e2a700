"""What the library needs of the compiler for browsers is there: that build takes minutes, and only a night makes it."""

from __future__ import annotations

import re
from pathlib import Path

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
