"""Whatever a scene file holds: both readers come to the same end, the commands say in one line what is wrong and where, within
bounded memory, and write nothing. `FRINGE_LONG_TESTS=1` adds the cases of gigabytes."""

import os
import resource
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis.pipeline.model_stage import model_module
from fem_reference.bodies.remarks import remarks
from geometries.common.errors import InputError
from geometries.scene import reader
from tests.bad_input.case import Case, as_root
from tests.bad_input.corpus import cases
from tests.waiting import DEADLINE

PROGRAM = Path(__file__).resolve().parents[2] / "build" / "bin" / "fringe"
LONG = "FRINGE_LONG_TESTS" in os.environ
# Of a command: far above what the cases need, far below what would trouble a machine.
MEMORY = 16 * 2**30 if LONG else 2**30
LONGEST_MESSAGE = 7000


def _command(name: str, scene: Path) -> subprocess.CompletedProcess[str]:
    command = [PROGRAM, name, scene]
    # A child that need not close what it does not know is made without a copy of this process, many times faster.
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
        errors="surrogateescape",
        close_fds=False,
    )
    resource.prlimit(process.pid, resource.RLIMIT_AS, (MEMORY, MEMORY))
    try:
        output, errors = process.communicate(timeout=DEADLINE)
    except subprocess.TimeoutExpired:
        process.kill()
        raise
    return subprocess.CompletedProcess(command, process.returncode, output, errors)


def _listing(folder: Path) -> set[tuple[str, int]]:
    return {(str(path), path.lstat().st_mtime_ns) for path in folder.rglob("*")}


def _assert_told(message: str, scene: Path, place: str) -> None:
    assert len(message) < LONGEST_MESSAGE + len(str(scene))
    assert message.removesuffix("\n").isprintable()
    # Of a path longer than any the middle is left out.
    assert str(scene)[:200] in message
    assert place in message.split(scene.name)[-1]


def _selected() -> list[Any]:
    made = [case for case in cases() if LONG or not case.long]
    return [pytest.param(case, marks=pytest.mark.night) if case.by_night else case for case in made]


@pytest.fixture
def skipping(case: Case) -> None:
    if "unreadable" in case.name and as_root():
        pytest.skip("permissions do not stop root")


@pytest.fixture
def folder() -> Iterator[Path]:
    """An empty folder. That of pytest would be looked for among those of all tests before, two thousand of them."""
    with tempfile.TemporaryDirectory() as name:
        yield Path(name)


@pytest.mark.usefixtures("skipping")
@pytest.mark.parametrize("case", _selected(), ids=lambda case: case.name)
def test_the_readers_agree_and_the_commands_say_so(folder: Path, case: Case) -> None:
    scene = case.make(folder)
    before = _listing(folder)
    try:
        here = reader.load(scene).conductors()
        refused = ""
    except InputError as error:
        refused = str(error)
    try:
        there = model_module().Scene.load(os.fsencode(scene).decode("utf-8", "surrogateescape")).conductors()
        refused_there = ""
    except ValueError as error:
        refused_there = str(error)
    if case.place is None:
        assert (refused, refused_there) == ("", "")
        assert set(here) <= set(there)
        for name, triangles in here.items():
            reach = np.abs(triangles).max()
            assert triangles.shape == there[name].shape
            assert np.abs(triangles - there[name]).max() <= 1e-12 * reach
    else:
        _assert_told(refused, scene, case.place)
        _assert_told(refused_there, scene, case.place)
    # All commands read with the same reader.
    for command in case.commands if case.place is None else case.commands[:1]:
        done = _command(command, scene)
        if case.place is None:
            assert done.returncode == 0
            told = done.stderr.splitlines()
            expected = [f"fringe: remark: {remark}" for remark in remarks(reader.load(scene))]
            # Those on what is measured are the command's own.
            assert told[: len(expected)] == expected
            assert command == "capacitance" or len(told) == len(expected)
            assert all(line.startswith("fringe: remark: ") for line in told)
            assert "nan" not in done.stdout.replace("nan", "", case.name.count("nan"))
        else:
            assert (done.returncode, done.stdout) == (2, "")
            assert done.stderr.startswith("fringe: ") and done.stderr.endswith("\n")
            _assert_told(done.stderr, scene, case.place)
    assert _listing(folder) == before
