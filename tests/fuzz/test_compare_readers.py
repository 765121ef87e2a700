"""Both readers end alike for files that nobody thought of; `tests/fuzz/run` tries more of them."""

import math
from pathlib import Path

import pytest

from geometries.common.errors import InputError
from geometries.scene import reader
from tests.fuzz import compare_readers
from tests.fuzz.seeds import ROOT


def test_files_spoiled_at_random_are_read_alike() -> None:
    assert compare_readers.compare(count=300, seconds=math.inf, seed=1) == (300, 0)


def test_a_reader_that_differs_is_found(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def refuses(path: Path) -> None:
        raise InputError(str(path), "", "is not for me")

    assert {seed.suffix for seed in compare_readers.sound_seeds(tmp_path)} == {
        ".toml",
        ".stl",
        ".obj",
        ".ply",
    }
    content = (ROOT / "geometries" / "scenes" / "guarded_sensor.toml").read_bytes()
    seed = compare_readers.Seed(".toml", content)
    assert compare_readers.disagreement(seed, content, tmp_path) == ""
    monkeypatch.setattr(compare_readers, "targets", lambda scene: (True,) * len(scene.objects))
    assert compare_readers.disagreement(seed, content, tmp_path).startswith("different roles")
    monkeypatch.setattr(reader, "load", refuses)
    assert "is not for me" in compare_readers.disagreement(seed, content, tmp_path)
