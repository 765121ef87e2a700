"""Mesh-size fields of gmsh: expressions, and distances to sampled faces and edges of polyhedra that occur in them.

gmsh 4.8 hangs on expressions that refer to other expressions; expressions that refer to distances work.
"""

from __future__ import annotations

from collections.abc import Sequence

import gmsh
import numpy as np
from numpy.typing import NDArray

from fem_reference.bodies.polyhedron import Polyhedron

POINTS_PER_CURVE = 200
"""Number of sample points on each sharp edge."""


def expression(text: str) -> int:
    """Add a field given by an expression in x, y, z."""
    return _field("MathEval", {}, {"F": text})


def smallest(fields: Sequence[int]) -> int:
    """Add the field that is the smallest of several fields at each point."""
    return _combined("Min", fields)


def name(field: int) -> str:
    """The name of a field for use in an expression; the field must not be an expression itself."""
    return f"F{field}"


def surface_distance(volumes: Sequence[int], spacing: float) -> int:
    """Add the distance to the surface of volumes, sampled at points about `spacing` apart."""
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
    """Add the distance to the sharp edges of a polyhedron; None when it has none."""
    ends = body.vertices[body.edges]
    faces = gmsh.model.getBoundary([(3, tag) for tag in volumes], oriented=False)
    curves = {tag for _, tag in gmsh.model.getBoundary(faces, combined=False, oriented=False)}
    chosen = []
    for curve in sorted(curves):
        points = gmsh.model.getBoundary([(1, curve)], combined=False, oriented=False)
        middle = np.mean([gmsh.model.getValue(0, point, []) for _, point in points], axis=0)
        if _is_on(middle, ends, 1e-6 * body.size):
            chosen.append(curve)
    if not chosen:
        return None
    field = _field("Distance", {"NNodesByEdge": POINTS_PER_CURVE}, {})
    gmsh.model.mesh.field.setNumbers(field, "EdgesList", chosen)
    return field


def _is_on(point: NDArray[np.float64], segments: NDArray[np.float64], tolerance: float) -> bool:
    """Whether a point (3,) lies on one of the segments (n, 2, 3)."""
    along = segments[:, 1] - segments[:, 0]
    to = point - segments[:, 0]
    share = np.clip(np.einsum("ij,ij->i", to, along) / np.einsum("ij,ij->i", along, along), 0, 1)
    return bool((np.linalg.norm(to - share[:, None] * along, axis=1) < tolerance).any())


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
