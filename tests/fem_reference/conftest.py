"""Environment of the tests of the field reference: compiled forms are kept with the build, and each process uses one core."""

import os
from pathlib import Path

os.environ.setdefault("XDG_CACHE_HOME", str(Path(__file__).resolve().parents[2] / "build" / "cache"))
os.environ.setdefault("OMP_NUM_THREADS", "1")
