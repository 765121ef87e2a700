"""Layers of both languages. Python packages import downwards only, without circles, and at the top of a file unless a slow library is the
reason. The rooms of model/src stand in layers: a file includes its own room and the rooms below it, and no includes go in a circle."""

import ast
import re
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


SOURCES = ROOT / "model" / "src"
HEADERS = ROOT / "model" / "include"
# The rooms from the bottom to the top. Vector registers need nothing; arithmetic, products of matrices and quadrature rules compute with
# them; shapes and poses are made of both. Files, integrals over triangles and collisions know shapes, but not each other. Surfaces are the
# bodies that carry charge, whose gaps collision measures; readings follow from the matrix of their conductors, whoever found it. Boundary
# elements integrate with the quadratures of the integrals; the pair formula needs no more; the reduced method compresses boundary elements.
# A sensing cone is a shape that collision measures; a scene asks them all.
ROOMS = (
    {"simd"},
    {"numeric"},
    {"geometry"},
    {"io", "integral", "collision"},
    {"surface"},
    {"readings"},
    {"bem", "formula"},
    {"reduced"},
    {"sensing"},
    {"scene"},
)
HEIGHT = {room: height for height, rooms in enumerate(ROOMS) for room in rooms}
# Its options, counts and constants are plain types that the integrals, the formula and the reduced method share with a scene.
TYPES_FOR_ALL = {"fringe/capacitance.hpp"}
# It gathers the kernels of all rooms for the files that are compiled for one instruction set each (simd/avx2.cpp and so on). No
# header of another room includes it, so no circle comes of it.
COMPILED_PER_INSTRUCTION_SET = "simd/all_kernels.hpp"


def included(folder: Path) -> dict[str, list[str]]:
    """What each file of C++ in a folder includes, by its path from there."""
    include = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)
    files = (path for path in folder.rglob("*") if path.suffix in {".cpp", ".hpp"})
    return {
        str(path.relative_to(folder)): include.findall(path.read_text(encoding="utf-8")) for path in files
    }


LIBRARY, PUBLIC = included(SOURCES), included(HEADERS)


def room(path: str) -> str:
    return path.split("/")[0]


def test_every_include_is_written_from_the_folder_of_the_sources() -> None:
    assert {room(path) for path in LIBRARY} == set(HEIGHT)
    assert not [
        f"{path}: {name}"
        for path, names in LIBRARY.items()
        for name in names
        if name not in LIBRARY and name not in PUBLIC
    ]


def test_no_file_includes_one_of_a_layer_above_or_of_another_room_of_its_own_layer() -> None:
    assert not [
        f"{path} ({room(path)}) includes {name}"
        for path, names in LIBRARY.items()
        for name in names
        if path != COMPILED_PER_INSTRUCTION_SET
        and name in LIBRARY
        and room(path) != room(name)
        and HEIGHT[room(name)] >= HEIGHT[room(path)]
    ]


def test_only_files_of_one_instruction_set_include_all_kernels() -> None:
    including = {path for path, names in LIBRARY.items() if COMPILED_PER_INSTRUCTION_SET in names}
    assert including == {f"simd/{name}.cpp" for name in ("scalar", "sse2", "avx2", "avx512")}


def test_no_room_uses_what_a_layer_above_implements_for_the_public() -> None:
    """A public header is implemented where the source of its name stands; a header of types alone has no such source."""
    owners = {f"fringe/{Path(path).stem}.hpp": room(path) for path in LIBRARY if path.endswith(".cpp")}
    assert not [
        f"{path} ({room(path)}) includes {name} of {owners[name]}"
        for path, names in LIBRARY.items()
        for name in names
        if name in owners and name not in TYPES_FOR_ALL and HEIGHT[owners[name]] > HEIGHT[room(path)]
    ]


def test_no_headers_include_each_other_in_a_circle() -> None:
    # Raises CycleError, which names the circle.
    TopologicalSorter(LIBRARY | PUBLIC).prepare()


def test_one_header_includes_all_public_ones() -> None:
    assert PUBLIC["fringe/fringe.hpp"] == sorted(set(PUBLIC) - {"fringe/fringe.hpp"})
