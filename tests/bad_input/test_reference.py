"""The field reference and scenes that cannot be read, or that can be read and have no capacitance: status 2, one line, nothing
written. In one process, but for a few: the command itself takes seconds to start."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from fem_reference.__main__ import main
from tests.bad_input import meshes, places, texts
from tests.bad_input.case import Case
from tests.waiting import DEADLINE

ROOT = Path(__file__).resolve().parents[2]
UNSOLVABLE = [case for case in meshes.cases() if case.unsolvable]
UNREADABLE = [
    case
    for case in [*texts.cases(), *places.cases()]
    if case.place is not None and "unreadable" not in case.name
]
# A closed surface around these would be none around a body.
UNWRAPPABLE = [
    case
    for case in UNSOLVABLE
    if case.name.endswith(("on one line", "of a point", "denormal size", "huge size"))
]
AS_PROCESSES = [case for case in UNREADABLE if case.name == "the scene is a pipe"]


def _assert_told(status: int, output: str, errors: str, scene: Path, place: str) -> None:
    assert (status, output) == (2, "")
    # Remarks on a scene precede its refusal.
    while errors.startswith("fem_reference: remark: "):
        errors = errors[errors.index("\n") + 1 :]
    assert errors.startswith("fem_reference: ") and errors.endswith("\n") and errors[:-1].isprintable()
    assert str(scene)[:200] in errors and place in errors


@pytest.mark.parametrize("case", UNREADABLE + UNWRAPPABLE, ids=lambda case: case.name)
def test_a_scene_that_cannot_be_solved(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], case: Case
) -> None:
    _assert_refused(tmp_path, capsys, case, [])


@pytest.mark.parametrize("case", UNSOLVABLE, ids=lambda case: case.name)
def test_a_mesh_that_bounds_no_solid_unless_it_may_be_wrapped(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], case: Case
) -> None:
    _assert_refused(tmp_path, capsys, case, ["--geometry", "exact"])


def _assert_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], case: Case, options: list[str]
) -> None:
    scene = case.make(tmp_path)
    before = sorted(tmp_path.rglob("*"))
    status = main([str(scene), "--json", *options])
    printed = capsys.readouterr()
    _assert_told(status, printed.out, printed.err, scene, case.place or case.unsolvable or "")
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("case", AS_PROCESSES, ids=lambda case: case.name)
def test_the_command_itself(tmp_path: Path, case: Case) -> None:
    scene = case.make(tmp_path)
    command = [sys.executable, "-m", "fem_reference", str(scene)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False, timeout=DEADLINE)
    _assert_told(done.returncode, done.stdout, done.stderr, scene, case.place or "")
