"""Environment of all tests: compiled forms are kept with the build, not in the user's cache, and each process uses one core."""

import os
from pathlib import Path

os.environ["XDG_CACHE_HOME"] = str(Path(__file__).resolve().parents[1] / "build" / "cache")
os.environ.setdefault("OMP_NUM_THREADS", "1")
