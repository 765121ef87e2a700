"""Files that are there whole or not at all."""

from __future__ import annotations

from pathlib import Path

import pytest

from geometries.files import whole_file


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
