"""What the build makes for other machines, made once: an installation and a Debian package."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tests import scenes

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build"

SCENE = scenes.SENSOR + scenes.body("hand", "plate", size=[0.073, 0.119], translation=[0.01, 0, 0.03])


def files_of(prefix: Path) -> set[Path]:
    """The files of the Python packages of an installation, except what Python compiles."""
    return {path for path in (prefix / "share/fringe").rglob("*") if "__pycache__" not in path.parts}


@pytest.fixture(scope="session")
def installation(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, set[Path]]:
    """Where everything is installed, a folder with a space, and the files before any test has used them."""
    folder = tmp_path_factory.mktemp("an installation") / "prefix"
    subprocess.run(["cmake", "--install", BUILD, "--prefix", folder], check=True, capture_output=True)
    return folder, files_of(folder)


@pytest.fixture(scope="session")
def prefix(installation: tuple[Path, set[Path]]) -> Path:
    return installation[0]


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "hand.toml"
    path.write_text(SCENE)
    return path
