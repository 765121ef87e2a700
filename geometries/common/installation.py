"""Where programs, caches and results are: in the repository beside its build, or installed (`cmake --install`)."""

from __future__ import annotations

import os
import shlex
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

# Where `cmake --install` puts these packages, below its prefix.
_PLACE = ("share", "fringe")
_PROGRAMS = {
    "geometries": "fringe-geometries",
    "fem_reference": "fringe-reference",
    "analysis": "fringe-analysis",
}


def is_installed() -> bool:
    """Tells whether these packages are a copy that `cmake --install` made: without the sources of the model, not to be written to."""
    return ROOT.parts[-2:] == _PLACE and not (ROOT / "CMakeLists.txt").is_file()


def command(package: str) -> str:
    """Returns how a user runs one of the packages."""
    return _PROGRAMS[package] if is_installed() else f"python3 -m {package}"


def model_command() -> str:
    """Returns how a user runs the model."""
    return "fringe" if is_installed() else "build/bin/fringe"


def from_repository(path: Path) -> str:
    """Returns a path as a command names it: from the repository's folder where it is in there, and quoted for a shell."""
    absolute = path.resolve()
    within = absolute.is_relative_to(ROOT)
    return shlex.quote(str(absolute.relative_to(ROOT) if within else absolute))


def module_folders() -> list[Path]:
    """Returns the folders that may hold the model's Python module, beside those on the path."""
    if is_installed():
        return sorted((ROOT.parents[1] / "lib").glob("python3*/dist-packages"))
    return [ROOT / "build" / "python"]


def cache_folder() -> Path:
    """Returns where compiled forms are kept: beside the build, or in the user's own cache."""
    if not is_installed():
        return ROOT / "build" / "cache"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "fringe"


def results_folder() -> Path:
    """Returns where results go if nothing else is said: into the repository, or where the user stands."""
    return (Path.cwd() if is_installed() else ROOT) / "results"


def how_to_get(module: str) -> str:
    """Tells a user how to get a missing Python module."""
    if is_installed():
        return f"apt-get install python3-{module}"
    return "./run installs what is missing"


def no_benchmark(program: Path) -> str:
    """Returns why a measurement of the model cannot be made: the program for it, named from the repository, is not there."""
    if is_installed():
        return f"{program.name} is not installed: the model is measured in the repository"
    return f"{program} is not there: ./run builds it"
