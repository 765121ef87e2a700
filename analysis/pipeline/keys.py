"""Computes the keys of stored answers. A key is a hash of everything that can change the answer: equal keys, equal answers.

It covers the scene, the options and the version of the code: a hash of the stage's
sources and, for the reference, the versions of the packages that it uses."""

import functools
import hashlib
import json
import re
from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

from geometries.common.installation import ROOT, is_installed, module_folders
from geometries.studies.study import Study

_SOURCE_SUFFIXES = {".cpp", ".hpp", ".h", ".txt", ".cmake", ".in"}
# The files of geometries that read scenes. A new family or a new motion must not invalidate answers.
_SCENE_SOURCES = ("common/errors.py", "common/tables.py", "scene/*.py")
_NOT_SOLVING = {"motion.py"}
_REPORT_SUFFIXES = {".css", ".html", ".js", ".py"}
_REFERENCE_PACKAGES = ("fenics-dolfinx", "fenics-basix", "petsc4py", "numpy")
_GMSH_VERSION = re.compile(r'^GMSH_API_VERSION *= *"([^"]+)"', re.MULTILINE)


def model_key(scene: str, study: Study, code: str) -> str:
    """Returns the key of a model answer; `scene` is its identity, `code` is `model_code`."""
    return _hash({"scene": scene, "methods": study.methods, "code": code})


def reference_key(scene: str, study: Study, code: str) -> str:
    """Returns the key of a reference answer; `scene` is its identity, `code` is `reference_code`."""
    options = {"rtol": study.rtol, "max_seconds": study.max_seconds, "error": study.error}
    return _hash({"scene": scene, "options": options, "code": code})


def boundary_key(scene: str, rtol: float, code: str) -> str:
    """Returns the key of an answer by boundary elements; `scene` is its identity, `code` is `model_code`."""
    return _hash({"scene": scene, "boundary elements": rtol, "code": code})


def slice_key(scene: str, code: str) -> str:
    """Returns the key of a slice of the potential; `scene` is its identity, `code` is `reference_code`."""
    return _hash({"scene": scene, "slice": True, "code": code})


def measurement_key(command: str, code: str, machine: dict[str, str]) -> str:
    """Returns the key of a measurement of the model by itself; `code` is `code_of` what it measures."""
    return _hash({"command": command, "code": code, "machine": machine})


def model_code(repository: Path = ROOT) -> str:
    """Returns the version of the model: a hash of its sources."""
    return code_of(["model"], repository)


def code_of(places: Iterable[str], repository: Path = ROOT) -> str:
    """Returns a hash of the files named, and of the C++ and CMake sources in the folders named."""
    found: list[Path] = []
    for place in (repository / name for name in places):
        found += [path for path in place.rglob("*") if path.suffix in _SOURCE_SUFFIXES]
        found += [place] if place.is_file() else []
    code = hash_of_files(found, repository)
    if not is_installed():
        return code
    # An installed copy has no sources; the hash of the module that was built from them takes their place.
    modules = [path for folder in module_folders() for path in folder.glob("fringe.*.so")]
    return _hash([code, *(hashlib.sha256(path.read_bytes()).hexdigest() for path in modules)])


def reference_code(repository: Path = ROOT) -> str:
    """Returns the version of the reference: a hash of its sources, of the scene reader's, and of the packages' versions."""
    solver, kinds = repository / "fem_reference", ("*.py", "*.cpp", "*.hpp")
    sources = [path for kind in kinds for path in solver.rglob(kind)]
    for pattern in _SCENE_SOURCES:
        found = (repository / "geometries").glob(pattern)
        sources += [path for path in found if path.name not in _NOT_SOLVING]
    packages = {name: _package_version(name) for name in _REFERENCE_PACKAGES} | {"gmsh": _gmsh_version()}
    return _hash({"sources": hash_of_files(sources, repository), "packages": packages})


def report_code(repository: Path = ROOT) -> str:
    """Returns the version of the report: a hash of this package, with its templates, styles and scripts."""
    found = (repository / "analysis").rglob("*")
    return hash_of_files((path for path in found if path.suffix in _REPORT_SUFFIXES), repository)


def page_inputs(*parts: object) -> str:
    """Computes a hash of everything that a page is made from: plain data, and the code of this package."""
    return _hash([*parts, _own_report_code()])


_own_report_code = functools.cache(report_code)
"""Hashes the files once, because a report has thousands of pages."""


def hash_of_files(paths: Iterable[Path], root: Path) -> str:
    """Computes sha256 over the names (relative to `root`) and the contents of files, sorted by name."""
    digest = hashlib.sha256()
    for path in sorted(paths):
        content = path.read_bytes()
        digest.update(f"{path.relative_to(root)} {len(content)}\n".encode())
        digest.update(content)
    return digest.hexdigest()


def _package_version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "absent"


def _gmsh_version() -> str:
    """Reads gmsh's version from its source: Debian's package has no metadata, and importing it takes half a second."""
    module = find_spec("gmsh")
    if module is None or module.origin is None:
        return "absent"
    found = _GMSH_VERSION.search(Path(module.origin).read_text(encoding="utf-8"))
    return found[1] if found else "unknown"


def _hash(parts: object) -> str:
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()
