"""Imports between the Python packages: downwards only, without circles, and at the top of a file unless a slow library is the reason."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# From the bottom up; a folder imports from itself and from what stands before it.
LAYERS = (
    "geometries.common",
    "geometries.scene",
    "geometries.studies",
    "geometries",
    "fem_reference.common",
    "fem_reference.bodies",
    "fem_reference.mesh",
    "fem_reference.solve",
    "fem_reference.answer",
    "fem_reference.output",
    "fem_reference",
    "analysis.results",
    "analysis.pipeline",
    "analysis.report",
    "analysis.topics",
    "analysis.study",
    "analysis.documentation",
    "analysis.show",
    "analysis.live",
    "analysis.sweep",
    "analysis.coverage",
    "analysis.honesty",
    "analysis.golden",
    "analysis.nightly",
    "analysis",
)
# A quarter of a second and more each, which a command that does not need them should not take; mpi4py starts MPI when it is loaded.
SLOW = {"dolfinx", "gmsh", "meshio", "mpi4py", "pandas", "scipy"}


def name_of(path: Path) -> str:
    name = ".".join(path.relative_to(ROOT).with_suffix("").parts)
    return name.removesuffix(".__init__")


MODULES = {
    name_of(path): path
    for package in ("geometries", "fem_reference", "analysis")
    for path in (ROOT / package).rglob("*.py")
}


def imported(node: ast.AST) -> list[str]:
    """The modules that a statement imports."""
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    if isinstance(node, ast.ImportFrom):
        assert node.level == 0 and node.module is not None
        whole = [f"{node.module}.{alias.name}" for alias in node.names]
        return [name if name in MODULES else node.module for name in whole]
    return []


@cache
def imports(module: str) -> tuple[set[str], set[str]]:
    """What a module imports when it is loaded, and what only when one of its functions runs."""
    tree = ast.parse(MODULES[module].read_text(encoding="utf-8"))
    everything = {name for node in ast.walk(tree) for name in imported(node)}
    at_once = {name for node in tree.body for name in imported(node)}
    return at_once, everything - at_once


def layer_of(module: str) -> int:
    return max(
        (index for index, layer in enumerate(LAYERS) if f"{module}.".startswith(f"{layer}.")),
        key=lambda index: len(LAYERS[index]),
    )


def loaded_with(module: str) -> Iterator[str]:
    """Every module and library that is loaded with a module."""
    seen, waiting = set(), [module]
    while waiting:
        name = waiting.pop()
        if name not in seen:
            seen.add(name)
            yield name
            waiting += imports(name)[0] if name in MODULES else []


def test_imports_lead_down() -> None:
    upwards = [
        f"{module} imports {name}"
        for module in MODULES
        for name in set.union(*imports(module))
        if name in MODULES and layer_of(name) > layer_of(module)
    ]
    assert not upwards


def test_no_modules_import_each_other_in_a_circle() -> None:
    graph = {module: [name for name in set.union(*imports(module)) if name in MODULES] for module in MODULES}
    # Raises CycleError, which names the circle.
    assert list(TopologicalSorter(graph).static_order())


def test_only_slow_libraries_are_imported_late() -> None:
    late = [
        f"{module} imports {name} within a function"
        for module in MODULES
        for name in imports(module)[1]
        if not SLOW & {found.split(".")[0] for found in loaded_with(name)}
    ]
    assert not late
