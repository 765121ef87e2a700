"""PLY files of text and of bytes: the vertices' x, y, z and the faces' lists of vertices; all else is left out."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from geometries.common.arrays import Array
from geometries.scene.faces import Surface, divided, name_points
from geometries.scene.mesh_numbers import Damaged, decimals, shown, whole

_TYPES = {
    b"char": "i1", b"int8": "i1", b"uchar": "u1", b"uint8": "u1", b"short": "i2", b"int16": "i2", b"ushort": "u2", b"uint16": "u2",
    b"int": "i4", b"int32": "i4", b"uint": "u4", b"uint32": "u4", b"float": "f4", b"float32": "f4", b"double": "f8", b"float64": "f8",
}  # fmt: skip
_ORDERS = {b"ascii": "", b"binary_little_endian": "<", b"binary_big_endian": ">"}
_LISTS = (b"vertex_indices", b"vertex_index")
_LINE = re.compile(rb"[^\n]*\n|[^\n]+\Z")


@dataclass(frozen=True)
class _Property:
    """`length` is the type of a list's length; empty: not a list."""

    name: bytes
    type: str
    length: str = ""


@dataclass
class _Element:
    name: bytes
    count: int
    properties: list[_Property] = field(default_factory=list)


def surface(content: bytes) -> Surface:
    """Returns the faces of a file's bytes in their order; Damaged when there is something else."""
    order, elements, body = _header(content)
    vertices = _only(elements, b"vertex", (b"x", b"y", b"z"))
    faces = _only(elements, b"face", ())
    source: _Source = _Bytes(body, order) if order else _Words(body.split())
    points: Array = np.empty((0, 3))
    outlines: list[list[int]] = []
    for element in elements:
        if element is vertices:
            points = _points(element, source)
        elif element is faces:
            outlines = _outlines(element, source)
        else:
            _skip(element, source)
    if not name_points(outlines, len(points)):
        raise Damaged("refers to a vertex that does not exist")
    if not np.isfinite(points).all():
        raise Damaged("contains a vertex that is not finite")
    return divided(points, outlines)


def _header(content: bytes) -> tuple[str, list[_Element], bytes]:
    """Returns the order of bytes, empty for text, the elements, and what follows."""
    if content.partition(b"\n")[0] not in (b"ply", b"ply\r"):
        raise Damaged("does not begin with the header of a PLY file")
    order, elements = None, []
    for line in _LINE.finditer(content, content.find(b"\n") + 1):
        words = line[0].split()
        if words == [b"end_header"]:
            break
        if not words or words[0] in (b"comment", b"obj_info"):
            continue
        if words[0] == b"format" and words[2:] == [b"1.0"] and words[1] in _ORDERS and order is None:
            order = _ORDERS[words[1]]
        elif words[0] == b"element" and len(words) == 3:
            elements.append(_Element(words[1], whole(words[2])))
        elif words[0] == b"property" and elements:
            elements[-1].properties.append(_property(words))
        else:
            raise Damaged(f"has a header with an unknown line: {shown(line[0])}")
    else:
        raise Damaged("has a header without an end")
    if order is None:
        raise Damaged("has a header without a format")
    if any(element.count < 0 for element in elements):
        raise Damaged("has a negative count of elements")
    return order, elements, content[line.end() :]


def _property(words: list[bytes]) -> _Property:
    types = words[2:4] if words[1:2] == [b"list"] else words[1:2]
    if len(words) != (5 if len(types) == 2 else 3) or any(name not in _TYPES for name in types):
        raise Damaged(f"has a header with an unknown property: {shown(b' '.join(words))}")
    if len(types) == 1:
        return _Property(words[2], _TYPES[types[0]])
    if types[0] in (b"float", b"float32", b"double", b"float64"):
        raise Damaged("has a list whose length is not an integer")
    return _Property(words[4], _TYPES[types[1]], _TYPES[types[0]])


def _only(elements: list[_Element], name: bytes, scalars: tuple[bytes, ...]) -> _Element:
    """Returns the one element of a name, which must have these numbers, or the list of a face's vertices."""
    found = [element for element in elements if element.name == name]
    if not found and name == b"face":
        raise Damaged("holds no triangles: it has no element face")
    if len(found) != 1:
        raise Damaged(f"has {len(found)} elements {name.decode()}, not one")
    properties = found[0].properties
    for wanted in scalars:
        if sum(known.name == wanted and not known.length for known in properties) != 1:
            raise Damaged(f"has vertices without {wanted.decode()}")
    if not scalars:
        lists = [known for known in properties if known.name in _LISTS and known.length]
        if len(lists) != 1:
            raise Damaged("has faces without a list of vertices")
        if lists[0].type.startswith("f"):
            raise Damaged("has vertex indices that are not integers")
    return found[0]


class _Words:
    """The values of a file of text, one after the other."""

    def __init__(self, words: list[bytes]) -> None:
        self._words, self._at = words, 0

    def take(self, count: int) -> list[bytes]:
        words = self._words[self._at : self._at + count]
        if len(words) < count:
            raise Damaged("ends before the data that its header announces")
        self._at += count
        return words

    def columns(self, element: _Element, names: tuple[bytes, ...]) -> list[Array]:
        width = len(element.properties)
        words = self.take(width * element.count)
        places = {known.name: at for at, known in enumerate(element.properties)}
        return [decimals(words[places[name] :: width]) for name in names]

    def number(self, kind: str) -> int:
        return whole(self.take(1)[0])

    def numbers(self, kind: str, count: int) -> list[int]:
        return [whole(word) for word in self.take(count)]

    def skip(self, kind: str, count: int) -> None:
        self.take(count)


class _Bytes:
    """The values of a file of bytes, one after the other."""

    def __init__(self, body: bytes, order: str) -> None:
        self._body, self._order, self._at = body, order, 0

    def _take(self, kind: np.dtype[np.void], count: int) -> NDArray[np.void]:
        if len(self._body) - self._at < count * kind.itemsize:
            raise Damaged("ends before the data that its header announces")
        values = np.frombuffer(self._body, kind, count, self._at)
        self._at += count * kind.itemsize
        return values

    def columns(self, element: _Element, names: tuple[bytes, ...]) -> list[Array]:
        # Two properties may have the same name, so they are identified by their index.
        places = {known.name: f"{at}" for at, known in enumerate(element.properties)}
        kind = np.dtype([(f"{at}", self._order + known.type) for at, known in enumerate(element.properties)])
        values = self._take(kind, element.count)
        with np.errstate(invalid="ignore"):  # Values that are not finite are refused with their mesh.
            return [values[places[name]].astype(np.float64) for name in names]

    def number(self, kind: str) -> int:
        return self.numbers(kind, 1)[0]

    def numbers(self, kind: str, count: int) -> list[int]:
        return [int(value) for value in self._take(np.dtype(self._order + kind), count)]

    def skip(self, kind: str, count: int) -> None:
        self._take(np.dtype(self._order + kind), count)


_Source = _Words | _Bytes


def _points(element: _Element, source: _Source) -> Array:
    axes = (b"x", b"y", b"z")
    if not any(known.length for known in element.properties):
        return np.stack(source.columns(element, axes), axis=1)
    points = []
    for _ in range(element.count):
        point = [0.0, 0.0, 0.0]
        for known in element.properties:
            if known.name in axes and not known.length:
                point[axes.index(known.name)] = source.columns(_Element(b"", 1, [known]), (known.name,))[0][0]
            else:
                _skip_value(known, source)
        points.append(point)
    return np.array(points)


def _outlines(element: _Element, source: _Source) -> list[list[int]]:
    found = []
    for face in range(element.count):
        for known in element.properties:
            if known.name in _LISTS and known.length:
                found.append(source.numbers(known.type, _length(known, source)))
                if len(found[-1]) < 3:
                    raise Damaged(f"has face {face} of fewer than three vertices")
            else:
                _skip_value(known, source)
    return found


def _skip(element: _Element, source: _Source) -> None:
    if not element.properties:
        return  # An element without properties takes no bytes, whatever its count.
    for _ in range(element.count):
        for known in element.properties:
            _skip_value(known, source)


def _skip_value(known: _Property, source: _Source) -> None:
    source.skip(known.type, _length(known, source) if known.length else 1)


def _length(known: _Property, source: _Source) -> int:
    length = source.number(known.length)
    if length < 0:
        raise Damaged("has a negative list length")
    return length
