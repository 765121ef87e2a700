"""Environment of all tests: compiled forms are kept with the build, not in the user's cache, and each process uses one core."""

import os
import sys
from pathlib import Path

import pytest

os.environ["XDG_CACHE_HOME"] = str(Path(__file__).resolve().parents[1] / "build" / "cache")
os.environ.setdefault("OMP_NUM_THREADS", "1")
# Python keeps the modules that it has compiled, whatever the environment says: otherwise each process that the tests start would
# compile the project's modules again.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False


@pytest.fixture
def scene(tmp_path: Path, request: pytest.FixtureRequest) -> Path:
    """A file of the scene that the module of the test names SCENE, and beside it that of its MOTION, if there is one."""
    path = tmp_path / "a scene.toml"
    path.write_text(request.module.SCENE)
    if motion := getattr(request.module, "MOTION", ""):
        path.with_suffix(".motion.toml").write_text(motion)
    return path
