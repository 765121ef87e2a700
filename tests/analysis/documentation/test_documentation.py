"""The documentation: every example says what it shows, the tutorial works as written, the site is made without a warning."""

from __future__ import annotations

import doctest
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from analysis import documentation
from analysis.documentation import make
from analysis.pipeline.model_stage import model_module

ROOT = Path(__file__).resolve().parents[3]
PAGES = Path(documentation.__file__).parent
TUTORIAL = (PAGES / "tutorial.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("page", sorted((PAGES / "algorithms").glob("*.md")), ids=lambda page: page.stem)
def test_an_algorithms_page_has_all_its_parts_and_its_example_holds(
    page: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = page.read_text(encoding="utf-8")
    for part in ("Formula", "Source", "Error", "Cost", "Example"):
        assert f"**{part}.**" in text
    monkeypatch.chdir(ROOT)
    model_module()
    assert doctest.testfile(str(page), module_relative=False).failed == 0


def test_the_scene_of_the_examples_is_the_readmes() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert (PAGES / "hand.toml").read_text(encoding="utf-8") in readme


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


def test_the_tutorial_leads_from_two_stl_files_to_a_report(tmp_path: Path) -> None:
    environment = {**os.environ, "FRINGE": str(ROOT), "PYTHONPATH": f"{ROOT}:{ROOT / 'build/python'}"}
    printed = []
    for language, file, block in _blocks():
        # The field solver takes minutes for its part, and has tests of its own.
        block = block.replace("rtol = 1e-2\nmax_seconds = 120", 'error = "none"')
        block = block.replace("scene.toml --error estimate --rtol 1e-2", "--version")
        if language == "toml":
            (tmp_path / file).write_text(block, encoding="utf-8")
            continue
        # Building is what comes before the tests.
        block = block.replace(
            '"$FRINGE/run" study.toml', "python3 -m analysis run study.toml --results results"
        )
        block = block.replace("show scene.toml", "show scene.toml --output show.html")
        block = re.sub(r"\bpython3\b", sys.executable, block)
        command = [sys.executable, "-c", block] if language == "python" else ["bash", "-ec", block]
        done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, block + done.stderr
        printed.append(done.stdout)
    # The box around the electrode is the rectangle that the scene has, from another corner, a millimetre thin.
    numbers = sorted(abs(float(number)) for number in re.findall(r"-?\d[\d.e-]*", printed[1]))[-4:]
    assert np.allclose(numbers, [0.04, 0.05, 0.08, 0.1])
    # The tutorial states what the model and its correction give.
    totals = [f"{float(total):.2f} pF" for total in re.findall(r"total +([\d.]+) pF", "".join(printed))]
    assert f"the model gives {totals[0]} and its correction {totals[1]}" in " ".join(TUTORIAL.split())
    results = tmp_path / "results"
    assert len(list(results.glob("cases/*/model.json"))) == 3 and (results / "report.html").is_file()


def _blocks() -> Iterator[tuple[str, str, str]]:
    """Language, the last file named before it, and content of every block of the tutorial."""
    for found in re.finditer(r"```(\w+)\n(.*?)```", TUTORIAL, re.DOTALL):
        named = re.findall(r"`([\w.]+\.toml)`", TUTORIAL[: found.start()])
        yield found[1], named[-1] if named else "", found[2]
