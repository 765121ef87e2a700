"""Meshes: damaged files, files that say what they are not, and sound files of surfaces that bound nothing."""

import struct
from collections.abc import Sequence
from pathlib import Path

from tests.bad_input.case import SCENE, SENSOR, Case, from_mesh, mesh_body

Point = tuple[float, float, float]
Face = Sequence[int]

# A tetrahedron whose faces are anticlockwise seen from outside.
POINTS: list[Point] = [(0, 0, 0), (0.125, 0, 0), (0, 0.125, 0), (0, 0, 0.125)]
FACES: list[Face] = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]


def ascii_stl(points: list[Point] = POINTS, faces: Sequence[Face] = FACES, name: str = "solid body") -> str:
    corners = ["".join(f"vertex {' '.join(map(repr, points[k]))}\n" for k in face) for face in faces]
    facets = [f"facet normal 0 0 0\nouter loop\n{corner}endloop\nendfacet\n" for corner in corners]
    return f"{name}\n{''.join(facets)}endsolid body\n"


def binary_stl(
    points: list[Point] = POINTS, faces: Sequence[Face] = FACES, header: bytes = b"", count: int | None = None
) -> bytes:
    facets = [struct.pack("<12fH", 0, 0, 0, *(x for k in face for x in points[k]), 0) for face in faces]
    return (
        header.ljust(80, b"\0") + struct.pack("<I", len(faces) if count is None else count) + b"".join(facets)
    )


def obj(points: list[Point] = POINTS, faces: Sequence[Face] = FACES) -> str:
    lines = [f"v {' '.join(map(repr, point))}\n" for point in points]
    return "".join(lines + [f"f {' '.join(str(k + 1) for k in face)}\n" for face in faces])


def _rows(points: list[Point]) -> list[str]:
    return [" ".join(map(repr, point)) for point in points]


def ply(points: list[Point] = POINTS, faces: Sequence[Face] = FACES, number: str = "float") -> str:
    head = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n"
    head += "".join(f"property {number} {axis}\n" for axis in "xyz")
    head += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    lines = [f"{row}\n" for row in _rows(points)]
    return head + "".join(lines + [f"{len(face)} {' '.join(map(str, face))}\n" for face in faces])


def binary_ply(order: str = "<") -> bytes:
    name = "little" if order == "<" else "big"
    head = ply().split("end_header\n")[0].replace("ascii", f"binary_{name}_endian") + "end_header\n"
    points = b"".join(struct.pack(f"{order}3f", *point) for point in POINTS)
    return head.encode() + points + b"".join(struct.pack(f"{order}B3i", 3, *face) for face in FACES)


def rich_ply(order: str = "<") -> bytes:
    """Whole numbers as coordinates, fractions of both lengths, and lists and elements that are no part of a surface."""
    name = "little" if order == "<" else "big"
    head = (
        f"ply\nformat binary_{name}_endian 1.0\nelement nothing 1000000000000\n"
        "element camera 2\nproperty double zoom\nproperty list short float matrix\n"
        "element vertex 4\nproperty list uchar short neighbours\nproperty short x\nproperty float y\nproperty double z\n"
        "element face 4\nproperty uint16 colour\nproperty list uint uchar vertex_index\nproperty list char int8 flags\n"
        "element edge 1\nproperty int first\nend_header\n"
    )
    cameras = struct.pack(f"{order}dhff", 1, 2, 3, 4) + struct.pack(f"{order}dh", 1, 0)
    rows = [struct.pack(f"{order}Bhhhfd", 2, -1, 9, round(-8 * x), y, z) for x, y, z in POINTS]
    faces = [struct.pack(f"{order}HI3Bbb", 9, 3, *face[::-1], 1, -1) for face in FACES]
    return head.encode() + cameras + b"".join(rows + faces) + struct.pack(f"{order}i", -1)


def rich_text_ply() -> str:
    """The same in text."""
    head = (
        rich_ply().split(b"end_header\n")[0].decode().replace("binary_little_endian", "ascii")
        + "end_header\n"
    )
    rows = [f"2 -1 9 {round(-8 * x)} {y!r} {z!r}\n" for x, y, z in POINTS]
    faces = [f"9 3 {' '.join(map(str, face[::-1]))} 1 -1\n" for face in FACES]
    return head + "1 2 3.5 4\n1 0\n" + "".join(rows + faces) + "-1\n"


def cases() -> list[Case]:
    return [*_whole(), *_stl(), *_obj(), *_ply(), *_surfaces(), _ten_million()]


def _meshes(contents: dict[str, bytes | str], place: str | None) -> list[Case]:
    return [from_mesh(name, content, place) for name, content in contents.items()]


def _whole() -> list[Case]:
    sound: dict[str, bytes | str] = {
        "stl of text": ascii_stl(),
        "stl of bytes": binary_stl(),
        "stl of text, line ends of two characters": ascii_stl().replace("\n", "\r\n"),
        "stl of text without a name": ascii_stl(name="solid"),
        "stl of text, indented by tabs": ascii_stl().replace("\n", "\n\t\t"),
        "obj": obj(),
        "obj of line ends of two characters": obj().replace("\n", "\r\n"),
        "obj that counts backwards": obj().split("f ")[0] + "f -4 -2 -3\nf -4 -3 -1\nf -4 -1 -2\nf -3 -2 -1\n",
        "obj in groups": "o a\n" + obj().replace("f 1 2 4", "g one\nusemtl red\nf 1 2 4").replace(
            "f 1 4 3", "g two\nusemtl blue\nf 1 4 3").replace("f 2 3 4", "g one\nusemtl red\nf 2 3 4"),
        "obj with normals and textures": obj().split("f ")[0] + "vn 0 0 1\nvt 0 0\n" + "".join(f"f {' '.join(f'{k + 1}/1/1' for k in face)}\n" for face in FACES),
        "obj with colours": "".join(f"{line} 1 0 0\n" if line.startswith("v ") else f"{line}\n" for line in obj().splitlines()),
        "obj with weights of one": "".join(f"{line} 1\n" if line.startswith("v ") else f"{line}\n" for line in obj().splitlines()),
        "obj of wide letters": obj().encode("utf-16"),
        "obj with a line that goes on": obj().replace("f 1 3 2", "f 1 3 \\\n2"),
        "obj whose last line would go on": obj().removesuffix("\n") + " \\",
        "obj whose last comment would go on": obj().removesuffix("\n") + " # the end \\",
        "stl of two solids": ascii_stl(faces=FACES[:2]) + ascii_stl(faces=FACES[2:]),
        "ply of text": ply(),
        "ply of bytes": binary_ply(),
        "ply of bytes, the big end first": binary_ply(">"),
        "ply with the key's other name": ply().replace("vertex_indices", "vertex_index"),
        "ply with comments": ply().replace("element vertex", "comment by hand\nobj_info none\nelement vertex"),
        "ply with colours": ply().replace("float z\n", "float z\nproperty uchar red\n").replace(
            "\n".join(_rows(POINTS)), "\n".join(f"{row} 255" for row in _rows(POINTS))),
        "ply of line ends of two characters": ply().replace("\n", "\r\n"),
        "ply of text with more than a surface": rich_text_ply(),
        "ply of bytes with more than a surface": rich_ply(),
        "ply of bytes with more than a surface, the big end first": rich_ply(">"),
    }  # fmt: skip
    return _meshes(sound, None)


def _stl() -> list[Case]:
    text, whole = ascii_stl(), binary_stl()
    damaged: dict[str, bytes | str] = {
        "stl without bytes": b"",
        "stl of text in capitals": text.upper(),
        "stl without facets, of text": "solid body\nendsolid body\n",
        "stl without facets, of bytes": binary_stl(faces=[]),
        "stl of text that ends early": text[: text.rindex("vertex")],
        "stl of text that ends within a number": text[: text.rindex("0.125") + 2],
        "stl of text without its last line": text.replace("endsolid body\n", ""),
        "stl of bytes that ends early": whole[:-1],
        "stl of bytes that ends a facet early": whole[:-50],
        "stl of bytes that ends in its count": whole[:82],
        "stl of bytes that ends in its header": whole[:40],
        "stl that counts too many": binary_stl(count=5),
        "stl that counts too few": binary_stl(count=3),
        "stl that counts none": binary_stl(count=0),
        "stl that counts all that can be counted": binary_stl(count=2**32 - 1),
        # 84 + 50 n is the file's size again, modulo 2^32.
        "stl whose count goes round": binary_stl(count=4 + 2**31),
        "stl that begins as text and counts wrong": binary_stl(header=b"solid body", count=5),
        "stl with a word before its solid": "once\n" + text,
        "stl with a word after its solid": text + "the end\n",
        "stl with a solid in a solid": text.replace("facet", "solid other\nfacet", 1),
        "stl with a wrong word in a facet": text.replace("outer loop", "outer ring", 1),
        "stl that ends in a facet": text.replace("endloop", "endsolid", 1),
        "stl with a facet of two corners": text.replace("vertex 0 0.125 0\n", "", 1),
        "stl with a facet of four corners": text.replace("endloop", "vertex 1 1 1\nendloop", 1),
        "stl with two coordinates": text.replace("vertex 0 0.125 0", "vertex 0 0.125", 1),
        "stl with a word for a number": text.replace("0.125", "far", 1),
        "stl with a decimal comma": text.replace("0.125", "0,125", 1),
        "stl with nan": text.replace("0.125", "nan", 1),
        "stl with inf": text.replace("0.125", "inf", 1),
        "stl with a number beyond all": text.replace("0.125", "1e999", 1),
        "stl of bytes with nan": binary_stl([*POINTS[:3], (0, 0, float("nan"))]),
        "stl of bytes with inf": binary_stl([*POINTS[:3], (0, 0, float("inf"))]),
        "stl that is an obj": obj(),
        "stl that is a ply": ply(),
        "stl that is a picture": b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 4,
        "stl that is prose": "this is a letter\n" * 20,
        "stl of one word": "solid",
    }  # fmt: skip
    sound: dict[str, bytes | str] = {
        "stl of bytes that begins as text does": binary_stl(header=b"solid body"),
        "stl of bytes that begins with text": binary_stl(header=b"solid body\nfacet normal 0 0 0\n"),
        "stl that ends in the line of its last facet": text.replace("\nendsolid", " endsolid"),
        "stl with a normal of any words": text.replace("normal 0 0 0", "normal up endsolid 0"),
    }
    return [*_meshes(damaged, "file"), *_meshes(sound, None)]


def _obj() -> list[Case]:
    text = obj()
    damaged: dict[str, bytes | str] = {
        "obj without bytes": b"",
        "obj of zeros": bytes(80),
        "obj that was not fetched": "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n",
        "obj of half a wide letter": text.encode("utf-16")[:-1],
        "obj with a weight of two": text.replace("v 0 0 0.125", "v 0 0 0.125 2"),
        "obj without faces": text.split("f ")[0],
        "obj without vertices": "f 1 2 3\n",
        "obj that is prose": "this is a letter\n" * 20,
        "obj that is an stl of bytes": binary_stl(),
        "obj that is an stl of text": ascii_stl(),
        "obj with vertex 0": text.replace("f 1 3 2", "f 0 3 2"),
        "obj with a vertex past its last": text.replace("f 1 3 2", "f 1 3 5"),
        "obj with a vertex before its first": text.replace("f 1 3 2", "f 1 3 -5"),
        "obj with a vertex of many digits": text.replace("f 1 3 2", "f 1 3 99999999999999999999"),
        "obj with a word for a vertex": text.replace("f 1 3 2", "f 1 3 two"),
        "obj with a fraction for a vertex": text.replace("f 1 3 2", "f 1 3 2.5"),
        "obj with a face of two": text.replace("f 1 3 2", "f 1 3"),
        "obj with a face of none": text.replace("f 1 3 2", "f"),
        "obj with two coordinates": text.replace("v 0 0 0.125", "v 0 0"),
        "obj with a word for a number": text.replace("v 0 0 0.125", "v 0 0 high"),
        "obj with half a number": text.replace("v 0 0 0.125", "v 0 0 0.1x"),
        "obj with a decimal comma": text.replace("v 0 0 0.125", "v 0 0 0,125"),
        "obj with nan": text.replace("v 0 0 0.125", "v 0 0 nan"),
        "obj of numbers too large to be squared": text.replace("v 0 0 0.125", "v 0 0 1e160"),
        "obj with inf": text.replace("v 0 0 0.125", "v 0 0 inf"),
        "obj with a number beyond all": text.replace("v 0 0 0.125", "v 0 0 1e999"),
        "obj with NUL": text.replace("v 0 0 0.125", "v 0 0 0.1\x0025"),
    }  # fmt: skip
    return _meshes(damaged, "file")


def _ply() -> list[Case]:
    text, whole = ply(), binary_ply()
    damaged: dict[str, bytes | str] = {
        "ply without bytes": b"",
        "ply of one word": "ply\n",
        "ply that ends in its header": text[:60],
        "ply without the end of its header": text.replace("end_header\n", ""),
        "ply without a format": text.replace("format ascii 1.0\n", ""),
        "ply of an unknown format": text.replace("ascii", "ebcdic"),
        "ply of an unknown type": text.replace("float z", "quad z"),
        "ply without vertices": ply(points=[]),
        "ply without faces": ply(faces=[]),
        "ply without z": text.replace("property float z\n", ""),
        "ply without a list of vertices": text.replace("vertex_indices", "neighbours"),
        "ply that ends early": text[:-4],
        "ply of bytes that ends early": whole[:-1],
        "ply of bytes that ends in its vertices": whole[:-70],
        "ply that counts too many": text.replace("face 4", "face 5"),
        "ply that counts too many vertices": text.replace("vertex 4", "vertex 5"),
        "ply that counts a thousand million": text.replace("face 4", "face 1000000000"),
        "ply that counts beyond all": text.replace("vertex 4", f"vertex {2**64}"),
        "ply of bytes that counts a thousand million": whole.replace(b"vertex 4", b"vertex 1000000000"),
        "ply that counts below zero": text.replace("face 4", "face -4"),
        "ply with a word for a number": text.replace("0.125 0 0", "far 0 0"),
        "ply of numbers too large to be squared": text.replace("float", "double").replace("0.125 0 0", "1e160 0 0"),
        "ply with nan": text.replace("0.125 0 0", "nan 0 0"),
        "ply with a number beyond all": text.replace("0.125 0 0", "1e999 0 0"),
        "ply with a vertex past its last": text.replace("3 0 2 1", "3 0 2 4"),
        "ply with a vertex before its first": text.replace("3 0 2 1", "3 0 2 -1"),
        "ply with a face of two": text.replace("3 0 2 1", "2 0 2"),
        "ply with a face of minus one": text.replace("3 0 2 1", "-1"),
        "ply with a face of a million": text.replace("3 0 2 1", "1000000 0 2 1"),
        "ply with a list of a length that is a fraction": text.replace("list uchar", "list float"),
        "ply with vertices named by fractions": text.replace("uchar int", "uchar float"),
        "ply of bytes with vertices named by fractions": whole.replace(b"uchar int", b"uchar float"),
        "ply with two elements of vertices": text.replace("element face", "element vertex 0\nelement face"),
        "ply of bytes with nan": whole.replace(struct.pack("<f", 0.125), struct.pack("<f", float("nan"))),
        "ply that ends in what is left out": rich_text_ply()[:-3],
        "ply of bytes that ends in what is left out": rich_ply()[:-1],
        "ply of bytes that counts a million million": rich_ply().replace(b"vertex 4", b"vertex 1000000000000"),
        "ply with a list of minus one value": rich_text_ply().replace("\n1 0\n", "\n1 -1\n"),
        "ply of bytes with a list of minus one value": rich_ply().replace(struct.pack("<dh", 1, 0), struct.pack("<dh", 1, -1)),
        "ply that is prose": "ply\n" + "this is a letter\n" * 20,
    }  # fmt: skip
    return _meshes(damaged, "file")


def _surfaces() -> list[Case]:
    """Any triangles are a surface to the model; the field reference asks for one that bounds a solid."""
    other = [(x + 0.03, y + 0.03, z + 0.03) for x, y, z in POINTS]
    flat: list[Point] = [(0, 0, 0), (0.125, 0, 0), (0.25, 0, 0)]
    many = [*POINTS, (0.0, 0.0, -0.125)]
    shifted = [tuple(k + 4 for k in face) for face in FACES]
    surfaces: dict[str, tuple[list[Point], Sequence[Face]]] = {
        "open": (POINTS, FACES[:3]),
        "flipped": (POINTS, [face[::-1] for face in FACES]),
        "with a flipped triangle": (POINTS, [FACES[0][::-1], *FACES[1:]]),
        "that meets itself": (POINTS + other, [*FACES, *shifted]),
        "with an edge of three triangles": (many, [*FACES, (0, 1, 4)]),
        "with a triangle twice": (POINTS, [*FACES, FACES[0]]),
        "with a triangle of two corners": (POINTS, [*FACES, (0, 0, 1)]),
        "with a triangle of one corner": (POINTS, [*FACES, (2, 2, 2)]),
        "of triangles on one line": (flat, [(0, 1, 2)]),
        "of a point": ([(0, 0, 0)] * 3, [(0, 1, 2)]),
        "of denormal size": ([(x * 1e-44, y * 1e-44, z * 1e-44) for x, y, z in POINTS], FACES),
        "of huge size": ([(x * 1e29, y * 1e29, z * 1e29) for x, y, z in POINTS], FACES),
    }
    made = []
    for name, (points, faces) in surfaces.items():
        # A triangle without area on an edge of a solid is left out.
        told = None if "corner" in name else "body"
        made.append(from_mesh(f"stl {name}", binary_stl(points, faces), None, told))
        made.append(from_mesh(f"obj {name}", obj(points, faces), None, told))
        made.append(from_mesh(f"ply {name}", ply(points, faces), None, told))
    return made


def _ten_million() -> Case:
    """A megabyte for every 20000 of them: half a gigabyte."""

    def make(folder: Path) -> Path:
        facet = binary_stl(faces=FACES[:1])[84:]
        with (folder / "mesh.stl").open("wb") as file:
            file.write(bytes(80) + struct.pack("<I", 10_000_000))
            for _ in range(100):
                file.write(facet * 100_000)
        (folder / SCENE).write_text(SENSOR + mesh_body("mesh.stl"))
        return folder / SCENE

    return Case("ten million triangles", make, None, long=True)
