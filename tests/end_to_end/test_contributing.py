"""CONTRIBUTING.md names folders, files and functions that exist."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
FOLLOWED = re.findall(r"^\| \d+ \| `([\w:]+)` \| `([\w./]+)` \|", CONTRIBUTING, re.MULTILINE)


def test_a_triangle_and_a_row_are_followed() -> None:
    chapters = [
        re.findall(r"^\| (\d+) \|", chapter, re.MULTILINE)
        for chapter in CONTRIBUTING.split("## Follow one")[1:]
    ]
    assert [len(numbers) <= most for numbers, most in zip(chapters, (12, 20), strict=True)] == [True, True]
    assert sum(map(len, chapters)) == len(FOLLOWED)


@pytest.mark.parametrize(("function", "file"), FOLLOWED)
def test_a_function_on_the_way_is_where_it_is_said_to_be(function: str, file: str) -> None:
    text = (ROOT / file).read_text(encoding="utf-8")
    defined = rf"^ *def {function}\(" if file.endswith(".py") else rf"^[\w].*\b{function}\("
    assert re.search(defined, text, re.MULTILINE)


@pytest.mark.parametrize("parent", ["analysis", "geometries", "model/src"])
def test_the_map_has_every_folder(parent: str) -> None:
    listed = subprocess.run(["git", "ls-files", parent], cwd=ROOT, capture_output=True, text=True, check=True)
    below = [Path(file).relative_to(parent).parts for file in listed.stdout.splitlines()]
    drawing = CONTRIBUTING.split("```")[1]
    assert not {parts[0] for parts in below if len(parts) > 1 and f"{parts[0]}/" not in drawing}


def test_the_source_files_that_the_notes_name_exist() -> None:
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True)
    files = [Path(file) for file in listed.stdout.splitlines()]
    for note in (file for file in files if file.suffix == ".md"):
        for name in re.findall(
            r"`([\w./*]+\.(?:cpp|hpp|py|js|css))`", (ROOT / note).read_text(encoding="utf-8")
        ):
            assert any(file.match(name) for file in files), f"{note}: {name}"
