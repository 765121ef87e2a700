"""The documentation: every example says what it shows, every figure is shown, tables are those of their programs, and the site is made without a warning."""

import doctest
import re
import subprocess
from pathlib import Path

import pytest

from analysis.documentation import make, measurements
from analysis.pipeline.model_stage import model_module
from geometries.common.installation import ROOT

PAGES = Path(make.__file__).parent


@pytest.mark.parametrize("page", sorted((PAGES / "algorithms").glob("*.md")), ids=lambda page: page.stem)
def test_an_algorithms_page_has_all_its_parts_and_its_example_holds(
    page: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for algorithm in page.read_text(encoding="utf-8").split("\n## ")[1:]:
        for part in ("Formula", "Source", "Error", "Cost", "Example"):
            assert f"**{part}.**" in algorithm
    monkeypatch.chdir(ROOT)
    model_module()
    assert doctest.testfile(str(page), module_relative=False).failed == 0


@pytest.mark.night
def test_the_site_is_made_without_a_warning(tmp_path: Path) -> None:
    first = make.build(tmp_path / "site")
    pages = {path.stem for path in (first.parent / "algorithms").glob("*.html")}
    assert pages == {path.stem for path in (PAGES / "algorithms").glob("*.md")}
    assert "plate_integral" in (first.parent / "python.html").read_text(encoding="utf-8")
    assert any((first.parent / "cpp").glob("*boundary__elements*.html"))


def test_a_folder_of_something_else_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "letters").write_text("dear")
    with pytest.raises(make.DocumentationError, match="not a site"):
        make.build(tmp_path)
    assert (tmp_path / "letters").is_file()


def test_every_figure_is_shown_and_small() -> None:
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True)
    files = [ROOT / name for name in listed.stdout.split()]
    notes = "".join(note.read_text(encoding="utf-8") for note in files if note.suffix == ".md")
    figures = [file for file in files if file.suffix == ".svg" and file.parent.name == "figures"]
    assert figures
    for figure in figures:
        assert f"figures/{figure.name})" in notes
        assert figure.stat().st_size < 50_000


PAGE = measurements.PAGE.read_text(encoding="utf-8")


def test_tables_are_replaced_and_nothing_else() -> None:
    printed = "other\n| a |\n|---|\n| 1 |\n\nmore\n| b |\n|---|\n| 2 |\n\n| c |\n|---|\n| 3 |\n"
    asked: list[str] = []

    def program(name: str) -> str:
        asked.append(name)
        return printed

    new = measurements.updated(PAGE, program)
    programs = ("boundary_elements_benchmark", "boundary_element_scenes_benchmark", "reduced_benchmark")
    assert asked == [f"build/bin/{program}" for program in programs]
    assert [new.count(table + "<!-- end -->") for table in measurements.tables(printed)] == [3, 3, 1]

    def without_tables(text: str) -> str:
        return re.sub(r"(<!-- table .*? -->).*?<!-- end -->", r"\1", text, flags=re.DOTALL)

    assert without_tables(new) == without_tables(PAGE)


@pytest.mark.parametrize(
    ("program", "count"), [("boundary_elements_benchmark", 2), ("boundary_element_scenes_benchmark", 3)]
)
def test_the_tables_have_the_columns_that_the_program_prints(program: str, count: int) -> None:
    source = (ROOT / "model/benchmarks" / f"{program}.cpp").read_text(encoding="utf-8")
    marked = re.findall(rf"<!-- table \d of build/bin/{program} -->\n(\|.*)\n(\|.*)\n", PAGE)
    assert len(marked) == count
    for header, line in marked:
        assert f"\\n{header}\\n{line}\\n" in source


def test_an_error_that_was_not_stated_is_no_table() -> None:
    printed = (
        "ball: 40 set-ups, 2 more whose truth was not found; the triangle integral takes 1.3 µs in the mean\n"
        "  reduced, rtol 0.01: error % median 0.0330, worst 0.1800; reached 40, worst 0.1800; covered 39; µs mean 6.6, median 4.8, longest 26\n"
    )
    with pytest.raises(ValueError, match="39 of 40 within"):
        measurements.reduced_tables(printed)


def test_lines_of_the_reduced_benchmark_become_tables() -> None:
    lines = [
        "{}: 40 set-ups, 2 more whose truth was not found; the triangle integral takes 1.3 µs in the mean\n",
        "  reduced, rtol 0.01: error % median 0.0330, worst 0.1800; reached 40, worst 0.1800; covered 40; µs mean 6.6, median 4.8, longest 26\n",
        "  reduced, rtol 0.001: error % median 0.0061, worst 0.0150; reached 0, worst 0.0000; covered 40; µs mean 24.2, median 10.1, longest 14372\n",
    ]
    groups = ("scene files", "plates, random poses", "boxes, random poses", "ball, random poses")
    first, second = measurements.tables(
        measurements.reduced_tables("".join("".join(lines).format(group) for group in groups))
    )
    assert first.count("\n") == 8 and second.count("\n") == 4
    assert (
        "| 40 set-ups of the default study (the triangle integral: 1.3 µs) | 0.01 | 0.033 / 0.18 | 40: 0.18 | 6.6 / 4.8 / 26 |"
        in first
    )
    assert "| ball, random poses, 40 (the triangle integral: 1.3 µs) | 0.01 |" in second
    assert "|  | 0.001 | 0.0061 / 0.015 | 0 | 24 / 10 / 14372 |" in second
