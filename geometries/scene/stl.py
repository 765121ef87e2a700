"""Reads STL files. A file is binary if its length fits its count of triangles, whatever its first bytes are."""

from __future__ import annotations

import numpy as np

from geometries.common.arrays import Array
from geometries.scene.faces import Surface
from geometries.scene.mesh_numbers import Damaged, decimals, plain_text, shown


_HEADER, _FACET = 84, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
# The words of one facet in a text file; None stands for a number.
_WORDS = (
    [b"facet", b"normal", None, None, None, b"outer", b"loop"]
    + [b"vertex", None, None, None] * 3
    + [b"endloop", b"endfacet"]
)
_CORNERS = [at for at, word in enumerate(_WORDS) if word is None and at > _WORDS.index(b"outer")]


def surface(content: bytes) -> Surface:
    """Returns the triangles of a file's bytes, in their order; Damaged when there is something else."""
    if len(content) >= _HEADER:
        count = int.from_bytes(content[_HEADER - 4 : _HEADER], "little")
        if len(content) == _HEADER + count * _FACET.itemsize:
            facets = np.frombuffer(content, _FACET, count, _HEADER)
            with np.errstate(invalid="ignore"):  # Values that are not finite are refused with their mesh.
                return Surface(np.asarray(facets["corners"], dtype=np.float64))
    content = plain_text(content)
    if not content.lstrip().startswith(b"solid"):
        raise Damaged(
            "is neither text that begins with 'solid' nor a binary file of the length that its count of triangles requires"
        )
    return Surface(_of_text(content))


def _of_text(content: bytes) -> Array:
    """Reads a text file; several solids in one file are one surface."""
    words: list[bytes] = []
    inside = False
    for number, line in enumerate(content.split(b"\n"), 1):
        in_line = line.split()
        if not in_line:
            continue
        if not inside:
            if in_line[0] != b"solid":
                raise Damaged(f"has {shown(in_line[0])} outside of any solid in line {number}")
            inside = True
            continue
        # Between two facets; the solid's name follows, as after 'solid'.
        begun = len(words)
        end = next(
            (
                at
                for at, word in enumerate(in_line)
                if word == b"endsolid" and (begun + at) % len(_WORDS) == 0
            ),
            None,
        )
        words += in_line[:end]
        inside = end is None
    if inside:
        raise Damaged("ends before its 'endsolid'")
    for place, expected in enumerate(_WORDS):
        if expected is None:
            continue
        for facet, word in enumerate(words[place :: len(_WORDS)]):
            if word != expected:
                raise Damaged(f"has {shown(word)} instead of '{expected.decode()}' in facet {facet}")
    columns = [decimals(words[place :: len(_WORDS)]) for place in _CORNERS]
    return np.stack(columns, axis=1).reshape(-1, 3, 3)
