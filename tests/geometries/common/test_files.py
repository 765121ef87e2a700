"""Files that are there whole or not at all."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from geometries.common.files import whole_file


def test_a_file_appears_when_it_is_finished(tmp_path: Path) -> None:
    target = tmp_path / "answer.json"
    with whole_file(target) as unfinished:
        unfinished.write_text("half")
        assert not target.exists() and unfinished.suffix == ".json"
    assert target.read_text() == "half" and list(tmp_path.iterdir()) == [target]


def test_an_error_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    target = tmp_path / "answer.json"
    target.write_text("old")
    with pytest.raises(KeyboardInterrupt):
        with whole_file(target) as unfinished:
            unfinished.write_text("ne")
            raise KeyboardInterrupt
    assert target.read_text() == "old" and list(tmp_path.iterdir()) == [target]


REPOSITORY = Path(__file__).resolve().parents[3]
WRITER = """
import sys
from pathlib import Path
from geometries.common.files import whole_file
with whole_file(Path(sys.argv[1])) as unfinished:
    unfinished.write_text("half")
    print(flush=True)
    sys.stdin.read()
"""


def test_what_a_killed_writer_left_goes_with_the_next_one(tmp_path: Path) -> None:
    target = tmp_path / "answer.json"
    with subprocess.Popen(
        [sys.executable, "-c", WRITER, str(target)],
        cwd=REPOSITORY,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    ) as writer:
        assert writer.stdout is not None
        writer.stdout.readline()
        with whole_file(target) as unfinished:
            unfinished.write_text("meanwhile")
        assert len(list(tmp_path.glob(".answer.*.json"))) == 1, "the other is still at it"
        writer.kill()
    with whole_file(tmp_path / "another.json") as unfinished:
        unfinished.write_text("whole")
    assert len(list(tmp_path.glob(".answer.*.json"))) == 1, "not of the same file"
    with whole_file(target) as unfinished:
        unfinished.write_text("whole")
    assert target.read_text() == "whole" and not list(tmp_path.glob(".*"))
