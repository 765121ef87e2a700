"""Nothing is left, neither a process nor a file, of a field solver that is ended while a program wraps a mesh."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests import scenes
from tests.waiting import heed_signals, marked, wait_until

ROOT = Path(__file__).resolve().parents[2]
WRAP = str(ROOT / "build" / "bin" / "fringe-wrap")
SCENE = scenes.body("tube", "mesh", file="tube.obj", potential="electrode")
# Smallest hollow (m) that the wrap is to follow: it takes far longer than the test.
ALPHA = "2e-4"


@pytest.fixture
def command(tmp_path: Path) -> list[str]:
    """The field solver for a square tube, open at both ends."""
    corners = 0.04 * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    lines = [f"v {x} {y} {z}" for z in (-0.5, 0.5) for x, y in corners]
    lines += [f"f {k + 1} {(k + 1) % 4 + 1} {(k + 1) % 4 + 5} {k + 5}" for k in range(4)]
    (tmp_path / "tube.obj").write_text("\n".join(lines) + "\n")
    (tmp_path / "scene.toml").write_text(SCENE)
    (tmp_path / "temporary").mkdir()
    return [sys.executable, "-m", "fem_reference", str(tmp_path / "scene.toml"), "--wrap-alpha", ALPHA]


def environment(folder: Path) -> dict[str, str]:
    return os.environ | {"TMPDIR": str(folder)}


def nothing_is_left(folder: Path) -> bool:
    return not marked(folder) and not list(folder.iterdir())


@pytest.mark.parametrize("ending", [signal.SIGKILL, signal.SIGHUP])
def test_the_wrap_ends_with_the_field_solver(
    tmp_path: Path, command: list[str], ending: signal.Signals
) -> None:
    folder = tmp_path / "temporary"
    with subprocess.Popen(
        command,
        cwd=ROOT,
        env=environment(folder),
        stderr=subprocess.PIPE,
        start_new_session=True,
        preexec_fn=heed_signals,
    ) as solver:
        try:
            wait_until(lambda: any(words.startswith(WRAP) for words in marked(folder).values()), "a wrap")
        finally:
            solver.send_signal(ending)
    wait_until(lambda: nothing_is_left(folder), "the end of all processes and files")


def test_the_limit_of_time_ends_a_wrap(tmp_path: Path, command: list[str]) -> None:
    folder = tmp_path / "temporary"
    words = [*command, "--max-seconds", "0.1", "--json"]
    done = subprocess.run(
        words, cwd=ROOT, env=environment(folder), capture_output=True, text=True, check=False
    )
    assert done.returncode == 3 and "no level was finished within 0.1 s; " in done.stderr
    assert "wrapped" in done.stderr and "--wrap-alpha" in done.stderr
    assert json.loads(done.stdout)["stopped_by"] == "no level was finished within 0.1 s"
    wait_until(lambda: nothing_is_left(folder), "the end of all processes and files")
