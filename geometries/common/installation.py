"""Locates programs, caches and results: in the repository beside its build, or installed (`cmake --install`)."""

from __future__ import annotations

import os
import shlex
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

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
