"""Runs `fringe import` for the tests of its formats."""

from __future__ import annotations

import math
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

from analysis.pipeline import model_stage
from geometries.scene import reader
from geometries.scene.scene import Scene
from tests.waiting import DEADLINE

ROOT = Path(__file__).resolve().parents[2]
SINGLE_PRECISION = 2e-7


def fringe_import(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Runs the command with these arguments."""
    # tests/clean/run lets valgrind watch.
    command = [
        *os.environ.get("FRINGE_WATCHED_BY", "").split(),
        ROOT / "build/bin/fringe",
        "import",
        *arguments,
    ]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=DEADLINE)


def imported(source: Path, *options: str | Path, warnings: str = "") -> Scene:
    """The scene made of a file; both readers have to see the same triangles in it. `warnings` is in what is told, if anything is."""
    target = source.with_name("scene.toml")
    done = fringe_import(source, target, *options)
    assert done.returncode == 0, done.stderr
    assert warnings in done.stderr if warnings else not done.stderr, done.stderr
    assert all(line.startswith(f"fringe: warning: {source}:") for line in done.stderr.splitlines())
    scene = reader.load(target)
    here, there = scene.conductors(), model_stage.model_module().Scene.load(str(target)).conductors()
    assert list(here) == list(there)
    for name, triangles in here.items():
        assert triangles == pytest.approx(there[name], abs=SINGLE_PRECISION)
    return scene


def assert_refused(source: Path, told: str, *options: str | Path) -> None:
    """A source is refused with one line that names it and the reason, and nothing is left behind."""
    before = set(source.parent.rglob("*"))
    done = fringe_import(source, source.parent / "new" / "wrong.toml", *options)
    assert (done.returncode, done.stdout) == (2, ""), done
    assert told in done.stderr and source.name in done.stderr, done.stderr
    assert len(done.stderr.splitlines()) == 1 and "unfinished" not in done.stderr
    assert set(source.parent.rglob("*")) == before


def about(axis: int, angle: float) -> np.ndarray:
    """The matrix of a rotation about a coordinate axis."""
    first, second = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[first, first] = matrix[second, second] = math.cos(angle)
    matrix[second, first] = math.sin(angle)
    matrix[first, second] = -math.sin(angle)
    return matrix


def affine(translation: list[float], linear: np.ndarray) -> np.ndarray:
    """The matrix (4, 4) of a linear map that a translation follows."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, translation
    return matrix
