"""Environment of all tests: compiled forms are kept with the build, not in the user's cache, and each process uses one core."""

import os
import sys
from pathlib import Path

os.environ["XDG_CACHE_HOME"] = str(Path(__file__).resolve().parents[1] / "build" / "cache")
os.environ.setdefault("OMP_NUM_THREADS", "1")
# Python keeps the modules that it has compiled, whatever the environment says: otherwise each process that the tests start would
# compile the project's modules again.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False
