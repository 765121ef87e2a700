"""The tutorial: its commands, in an empty folder with nothing but what is installed, print what it shows."""

from __future__ import annotations

import pytest

import math
import os
import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

from tests.packaging.conftest import BUILD, ROOT, files_of

pytestmark = pytest.mark.night

TUTORIAL = (ROOT / "analysis/documentation/tutorial.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"```sh\n(.*?)```(?:\n\n```text\n(.*?)```)?", re.DOTALL)
# Times depend on the machine.
SECONDS = re.compile(r"[\d.e-]+ s\b")
# Digits of answers whose errors are estimated may differ by some of these errors between machines.
TOLERANCE = 0.02


def steps() -> Iterator[tuple[str, str]]:
    """Commands, and what the page shows that they print."""
    for found in BLOCK.finditer(TUTORIAL):
        yield found[1], found[2] or ""


def words(printed: str, folder: Path) -> list[str]:
    return SECONDS.sub("", printed.replace(f"{folder.resolve()}/", "…/")).split()


def agrees(printed: str, shown: str) -> bool:
    try:
        return math.isclose(float(printed), float(shown), rel_tol=TOLERANCE, abs_tol=1e-3)
    except ValueError:
        return printed == shown


def test_the_commands_print_what_the_tutorial_shows(
    installation: tuple[Path, set[Path]], tmp_path: Path
) -> None:
    prefix, installed = installation
    # The cache of the build holds the forms that the field solver would otherwise compile first.
    environment = os.environ | {
        "PATH": f"{prefix / 'bin'}:{os.environ['PATH']}",
        "PYTHONPATH": str(next(prefix.glob("lib/python3*/dist-packages"))),
        "XDG_CACHE_HOME": str(BUILD / "cache"),
    }
    for commands, shown in steps():
        done = subprocess.run(
            ["bash", "-ec", commands], cwd=tmp_path, env=environment, capture_output=True, text=True
        )
        assert done.returncode == 0, commands + done.stderr
        printed, expected = words(done.stdout, tmp_path), words(shown, tmp_path)
        assert len(printed) == len(expected), done.stdout
        assert all(map(agrees, printed, expected)), done.stdout
    assert (tmp_path / "scene.html").is_file() and (tmp_path / "results/my_sensor/report.html").is_file()
    assert files_of(prefix) == installed


def test_every_output_of_the_tutorial_is_compared() -> None:
    assert TUTORIAL.count("```text\n") == sum(bool(shown) for _, shown in steps()) == 8
