"""Finds the Python that has the packages: Debian installs them for its own, and another may come first on the path."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys

from geometries.common.children import ending_with_this
from geometries.common.installation import how_to_get

DEBIAN_PYTHON = "/usr/bin/python3"


def continue_with(module: str) -> None:
    """Returns if this interpreter has `module`; else runs the same command again with Debian's Python.

    Exits with status 1 and a message if that lacks the module, too. Call it before any import that needs packages.
    """
    if importlib.util.find_spec(module) is not None:
        return
    if not _is_debians() and _has(DEBIAN_PYTHON, module):
        os.execv(DEBIAN_PYTHON, [DEBIAN_PYTHON, *sys.orig_argv[1:]])
    others = "" if _is_debians() else f", nor does {DEBIAN_PYTHON}"
    sys.exit(f"{sys.executable} does not have the module {module}{others}: {how_to_get(module)}")


def _is_debians() -> bool:
    return os.path.realpath(sys.executable) == os.path.realpath(DEBIAN_PYTHON)


def _has(interpreter: str, module: str) -> bool:
    command = [
        interpreter,
        "-c",
        f"import importlib.util as u; raise SystemExit(u.find_spec({module!r}) is None)",
    ]
    try:
        return subprocess.run(ending_with_this(command), capture_output=True, check=False).returncode == 0
    except OSError:
        return False
