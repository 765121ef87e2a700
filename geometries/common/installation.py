"""Locates programs, caches and results: in the repository beside its build, or installed (`cmake --install`).

Also finds the Python that has the packages: Debian installs them for its own, and another may come first on the path.
"""

from __future__ import annotations

import importlib.util
import os
import shlex
import subprocess
import sys
from pathlib import Path

from geometries.common.children import ending_with_this

ROOT = Path(__file__).resolve().parents[2]
DEBIAN_PYTHON = "/usr/bin/python3"

# The folder of these packages below the prefix of `cmake --install`.
_PLACE = ("share", "fringe")
_PROGRAMS = {
    "geometries": "fringe-geometries",
    "fem_reference": "fringe-reference",
    "analysis": "fringe-analysis",
}


def is_installed() -> bool:
    """Tells whether these packages were installed by `cmake --install`: without the model's sources, and not to be written to."""
    return ROOT.parts[-2:] == _PLACE and not (ROOT / "CMakeLists.txt").is_file()


def command(package: str) -> str:
    """Returns the command that runs one of the packages."""
    return _PROGRAMS[package] if is_installed() else f"python3 -m {package}"


def model_command() -> str:
    """Returns the command that runs the model."""
    return "fringe" if is_installed() else "build/bin/fringe"


def model_program() -> Path:
    """Returns where the command `fringe` is."""
    return (ROOT.parents[1] if is_installed() else ROOT / "build") / "bin" / "fringe"


def wrap_program() -> Path:
    """Returns where the program is that wraps meshes for the field reference."""
    return _own_programs() / "fringe-wrap"


def sizes_library() -> Path:
    """Returns where the library is by which the field reference's mesher finds the size of its cells."""
    return _own_programs() / "fringe-sizes.so"


def _own_programs() -> Path:
    return ROOT.parents[1] / "libexec" / "fringe" if is_installed() else ROOT / "build" / "bin"


def page_library() -> Path:
    """Returns where the library for live pages is: JavaScript with the library in WebAssembly, which emscripten makes."""
    folder = ROOT.parents[1] / "share" / "fringe" if is_installed() else ROOT / "build-browser" / "bin"
    return folder / "fringe_page.js"


def from_repository(path: Path) -> str:
    """Returns a path for a shell command: relative to the repository if it is within, and quoted."""
    absolute = path.resolve()
    within = absolute.is_relative_to(ROOT)
    return shlex.quote(str(absolute.relative_to(ROOT) if within else absolute))


def module_folders() -> list[Path]:
    """Returns the folders, besides those on the path, that may hold the model's Python module."""
    if is_installed():
        return sorted((ROOT.parents[1] / "lib").glob("python3*/dist-packages"))
    return [ROOT / "build" / "python"]


def cache_folder() -> Path:
    """Returns the folder of compiled forms: beside the build, or in the user's cache."""
    if not is_installed():
        return ROOT / "build" / "cache"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "fringe"


def is_own(path: Path) -> bool:
    """Tells whether a file lies within the repository, and so may have its results there."""
    return not is_installed() and path.resolve().is_relative_to(ROOT)


def results_folder(source: Path = ROOT) -> Path:
    """Returns the default folder of what is made from a file: in the repository if the file is, else in the current folder."""
    return (ROOT if is_own(source) else Path.cwd()) / "results"


def how_to_get(module: str) -> str:
    """Tells a user how to get a missing Python module."""
    if is_installed():
        return f"apt-get install python3-{module}"
    return "./run installs what is missing"


def no_benchmark(program: Path) -> str:
    """Returns why a measurement of the model cannot be made: its program, named from the repository, is missing."""
    if is_installed():
        return f"{program.name} is not installed: the model is measured in the repository"
    return f"{program} is missing: ./run builds it"


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
