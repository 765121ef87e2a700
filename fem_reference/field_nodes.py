"""Mesh-size fields for bodies whose distance is no closed form: gmsh's distances to sampled faces and edges of polyhedra.

gmsh 4.8 hangs on expressions that refer to other fields, so sizes are put together by Threshold (a line through a
distance), Min and Max fields. Where the closed forms add two lengths, the larger one stands here: at most half as much.
"""

from __future__ import annotations

from collections.abc import Sequence

import gmsh
import numpy as np

from fem_reference.polyhedron import Polyhedron

FAR = 1e4
"""A distance beyond the outer sphere."""
POINTS_PER_CURVE = 200


def expression(text: str) -> int:
    """A field from an expression in x, y, z."""
    return _field("MathEval", {}, {"F": text})


def smallest(fields: Sequence[int]) -> int:
    return _combined("Min", fields)


def largest(fields: Sequence[int]) -> int:
    return _combined("Max", fields)


def line(distance: int, offset: float, slope: float) -> int:
    """offset + slope·distance."""
    numbers = {
        "IField": distance,
        "DistMin": 0,
        "DistMax": FAR,
        "LcMin": offset,
        "LcMax": offset + slope * FAR,
    }
    return _field("Threshold", numbers, {})


def surface_distance(volumes: Sequence[int], spacing: float) -> int:
    """Distance to the surface of volumes, from points at about `spacing` on it."""
    faces = [tag for _, tag in gmsh.model.getBoundary([(3, tag) for tag in volumes], oriented=False)]
    groups: dict[int, list[int]] = {}
    for face in faces:
        box = np.array(gmsh.model.getBoundingBox(2, face)).reshape(2, 3)
        count = int(np.clip(np.linalg.norm(box[1] - box[0]) / spacing, 2, 2000))
        groups.setdefault(1 << (count - 1).bit_length(), []).append(face)
    fields = []
    for count, group in groups.items():
        field = _field("Distance", {"NNodesByEdge": count}, {})
        gmsh.model.mesh.field.setNumbers(field, "FacesList", group)
        fields.append(field)
    return fields[0] if len(fields) == 1 else smallest(fields)


def edge_distance(body: Polyhedron, volumes: Sequence[int]) -> int | None:
    """Distance to the sharp edges of a polyhedron; None when it has none."""
    sharp = body.vertices[body.edges].mean(axis=1)
    faces = gmsh.model.getBoundary([(3, tag) for tag in volumes], oriented=False)
    curves = {tag for _, tag in gmsh.model.getBoundary(faces, combined=False, oriented=False)}
    chosen = []
    for curve in sorted(curves):
        ends = gmsh.model.getBoundary([(1, curve)], combined=False, oriented=False)
        middle = np.mean([gmsh.model.getValue(0, point, []) for _, point in ends], axis=0)
        if len(sharp) and np.linalg.norm(sharp - middle, axis=1).min() < 1e-6 * body.size:
            chosen.append(curve)
    if not chosen:
        return None
    field = _field("Distance", {"NNodesByEdge": POINTS_PER_CURVE}, {})
    gmsh.model.mesh.field.setNumbers(field, "EdgesList", chosen)
    return field


def _combined(kind: str, fields: Sequence[int]) -> int:
    field = _field(kind, {}, {})
    gmsh.model.mesh.field.setNumbers(field, "FieldsList", list(fields))
    return field


def _field(kind: str, numbers: dict[str, float], texts: dict[str, str]) -> int:
    field: int = gmsh.model.mesh.field.add(kind)
    for name, number in numbers.items():
        gmsh.model.mesh.field.setNumber(field, name, number)
    for name, text in texts.items():
        gmsh.model.mesh.field.setString(field, name, text)
    return field
