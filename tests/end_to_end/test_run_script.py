"""./run works wherever the user stands."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def test_a_folder_named_like_ours_where_the_user_stands_is_not_taken_for_ours(tmp_path: Path) -> None:
    for name in ("analysis", "geometries"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text("raise SystemExit('the wrong package')")
    done = subprocess.run(
        [ROOT / "run", "no such study"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 2, done.stderr
    assert "no such study" in done.stderr and "wrong package" not in done.stderr


@pytest.mark.parametrize(
    ("given", "asked"),
    [
        ("./run", ["errors", "corrections", "run default --measure-model"]),
        ("./run experiment_1", ["run experiment_1"]),
        ("./run nightly --profile slurm", ["nightly nightly --verify --profile slurm"]),
    ],
)
def test_what_it_asks_of_the_analysis(tmp_path: Path, given: str, asked: list[str]) -> None:
    """A repository with nothing in it: no package is missing, nothing is built, and the analysis says what it was asked."""
    folder = tmp_path / "a repository"
    (folder / "analysis").mkdir(parents=True)
    (folder / "analysis" / "__main__.py").write_text("import sys\nprint('asked:', *sys.argv[1:])\n")
    (folder / "packages.txt").write_text("# none\n")
    (folder / "cmake").write_text("#!/bin/sh\n")
    (folder / "cmake").chmod(0o755)
    shutil.copy(ROOT / "run", folder / "run")
    done = subprocess.run(
        [folder / "run", *given.split()[1:]],
        env=os.environ | {"PATH": f"{folder}:{os.environ['PATH']}"},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    )
    assert re.findall(r"asked: (.*)", done.stdout) == asked
