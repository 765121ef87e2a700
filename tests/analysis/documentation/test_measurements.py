"""The page of measurements holds the tables of its programs, and the command replaces these and nothing else."""

from __future__ import annotations

import re

from analysis.documentation import measurements
from analysis.pipeline.keys import REPOSITORY

PAGE = measurements.PAGE.read_text(encoding="utf-8")


def test_tables_are_replaced_and_nothing_else() -> None:
    printed = "other\n| a |\n|---|\n| 1 |\n\nmore\n| b |\n|---|\n| 2 |\n"
    asked: list[str] = []

    def program(name: str) -> str:
        asked.append(name)
        return printed

    new = measurements.updated(PAGE, program)
    assert asked == ["build/bin/boundary_elements_benchmark"]
    first, second = measurements.tables(printed)
    assert first + "<!-- end -->" in new and second + "<!-- end -->" in new

    def without_tables(text: str) -> str:
        return re.sub(r"(<!-- table .*? -->).*?<!-- end -->", r"\1", text, flags=re.DOTALL)

    assert without_tables(new) == without_tables(PAGE)


def test_the_tables_have_the_columns_that_the_program_prints() -> None:
    source = (REPOSITORY / "model/benchmarks/boundary_elements_benchmark.cpp").read_text(encoding="utf-8")
    marked = re.findall(r"<!-- table \d of \S+ -->\n(\|.*)\n(\|.*)\n", PAGE)
    assert len(marked) == 2
    for header, line in marked:
        assert f"\\n{header}\\n{line}\\n" in source
