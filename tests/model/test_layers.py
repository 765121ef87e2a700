"""The rooms of model/src stand in layers: a file includes its own room and the rooms below it, and no includes go in a circle."""

from __future__ import annotations

import re
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ROOT / "model" / "src"
HEADERS = ROOT / "model" / "include"

# The layers from the bottom to the top. Vector registers need nothing; arithmetic, products of matrices and quadrature rules compute with
# them; shapes and poses are made of both. Files, integrals over triangles and collisions know shapes, but not each other. Surfaces are the
# bodies that carry charge, whose gaps collision measures; readings follow from the matrix of their conductors, whoever found it. Boundary
# elements integrate with the quadratures of the integrals; the pair formula needs no more; the reduced method compresses boundary elements.
# A sensing cone is a shape that collision measures; a scene asks them all.
LAYERS = (
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
LAYER = {room: height for height, rooms in enumerate(LAYERS) for room in rooms}

# Its options, counts and constants are plain types that the integrals, the formula and the reduced method share with a scene.
TYPES_FOR_ALL = {"fringe/capacitance.hpp"}

# It gathers the kernels of all rooms for the files that are compiled for one instruction set each (simd/avx2.cpp and so on). No
# header of another room includes it, so no circle comes of it.
COMPILED_PER_INSTRUCTION_SET = "simd/all_kernels.hpp"

INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)


def includes(path: Path) -> list[str]:
    return INCLUDE.findall(path.read_text(encoding="utf-8"))


def sources() -> dict[str, list[str]]:
    """What each file of the library includes, by its path from model/src."""
    files = (path for path in SOURCES.rglob("*") if path.suffix in {".cpp", ".hpp"})
    return {str(path.relative_to(SOURCES)): includes(path) for path in files}


def room(path: str) -> str:
    return path.split("/")[0]


def circle(arrows: dict[str, list[str]]) -> list[str]:
    try:
        TopologicalSorter(arrows).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def test_every_include_is_written_from_the_folder_of_the_sources() -> None:
    wrong = [
        f"{path}: {name}"
        for path, names in sources().items()
        for name in names
        if not (SOURCES / name).is_file() and not (name.startswith("fringe/") and (HEADERS / name).is_file())
    ]
    assert not wrong


def test_every_file_stands_in_a_room() -> None:
    assert {room(path) for path in sources()} == set(LAYER)


def test_no_file_includes_one_of_a_layer_above_or_of_another_room_of_its_own_layer() -> None:
    wrong = [
        f"{path} ({room(path)}) includes {name}"
        for path, names in sources().items()
        for name in names
        if path != COMPILED_PER_INSTRUCTION_SET
        and not name.startswith("fringe/")
        and room(path) != room(name)
        and LAYER[room(name)] >= LAYER[room(path)]
    ]
    assert not wrong


def test_only_files_of_one_instruction_set_include_all_kernels() -> None:
    including = {path for path, names in sources().items() if COMPILED_PER_INSTRUCTION_SET in names}
    assert including == {f"simd/{name}.cpp" for name in ("scalar", "sse2", "avx2", "avx512")}


def test_no_room_uses_what_a_layer_above_implements_for_the_public() -> None:
    """A public header is implemented where the source of its name stands; a header of types alone has no such source."""
    owners = {f"fringe/{Path(path).stem}.hpp": room(path) for path in sources() if path.endswith(".cpp")}
    wrong = [
        f"{path} ({room(path)}) includes {name} of {owners[name]}"
        for path, names in sources().items()
        for name in names
        if name in owners and name not in TYPES_FOR_ALL and LAYER[owners[name]] > LAYER[room(path)]
    ]
    assert not wrong


def test_no_headers_include_each_other_in_a_circle() -> None:
    arrows = sources()
    for header in HEADERS.rglob("*.hpp"):
        arrows[str(header.relative_to(HEADERS))] = includes(header)
    assert not circle(arrows)


def test_a_circle_is_found() -> None:
    assert circle({"a": ["b"], "b": ["c"], "c": ["a"]})
    assert not circle({"a": ["b", "c"], "b": ["c"], "c": []})


def test_one_header_includes_all_public_ones() -> None:
    public = sorted(f"fringe/{path.name}" for path in (HEADERS / "fringe").glob("*.hpp"))
    public.remove("fringe/fringe.hpp")
    assert includes(HEADERS / "fringe/fringe.hpp") == public
