"""Find the Python that has the packages: Debian installs them for its own, and another may stand first on the path."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys

from geometries.installation import how_to_get

DEBIAN_PYTHON = "/usr/bin/python3"


def continue_with(module: str) -> None:
    """Return if this interpreter has `module`; else run the same command again with Debian's Python, which should.

    Exits with status 1 and a sentence when that has not got it either. Call it before any import that needs packages.
    """
    if importlib.util.find_spec(module) is not None:
        return
    if os.path.realpath(sys.executable) != os.path.realpath(DEBIAN_PYTHON) and _has(DEBIAN_PYTHON, module):
        os.execv(DEBIAN_PYTHON, [DEBIAN_PYTHON, *sys.orig_argv[1:]])
    sys.exit(f"neither {sys.executable} nor {DEBIAN_PYTHON} has the module {module}: {how_to_get(module)}")


def _has(interpreter: str, module: str) -> bool:
    command = [
        interpreter,
        "-c",
        f"import importlib.util as u; raise SystemExit(u.find_spec({module!r}) is None)",
    ]
    try:
        return subprocess.run(command, capture_output=True, check=False).returncode == 0
    except OSError:
        return False
