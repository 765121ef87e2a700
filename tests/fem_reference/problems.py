"""Bodies, conductors and matrices that several tests of the field solver share."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from fem_reference.bodies.conductors import Conductors, scaled
from fem_reference.bodies.round_bodies import Arc, Cone, Cylinder, Ellipsoid, Sphere, Swept
from fem_reference.bodies.shapes import Body, Cuboid, Disc, PlanePolygon, Rectangle
from fem_reference.mesh.body_distances import ClosedFormBody
from geometries.common.arrays import Array
from geometries.scene import polygons
from geometries.scene.poses import AxisRotation

ORIGIN = np.zeros(3)
CENTRE = np.array([0.1, -0.2, 0.3])
TURNED = AxisRotation((1.0, 2.0, -0.5), 33.0).matrix().T


def conductors_of(bodies: Sequence[Body], sensors: int = 1, **others: Any) -> Conductors:
    """Bodies of which each is a conductor, unless `others` name the last of them as floating, grounded or dielectric."""
    count = len(bodies) - sum(len(others.get(kind, ())) for kind in ("floating", "grounded", "dielectrics"))
    names = tuple(body.name for body in bodies[:count])
    return scaled(Conductors(names, sensors, tuple(bodies), tuple(range(len(bodies))), **others))


def plate(name: str, half_widths: tuple[float, float] = (0.5, 0.5), *centre: float) -> Rectangle:
    """A plate at right angles to z; at the origin unless a centre is given."""
    return Rectangle(name, np.array(centre or ORIGIN), np.eye(3), half_widths)


def polygon(name: str, vertices: Sequence[tuple[float, float]], centre: Array, axes: Array) -> PlanePolygon:
    return PlanePolygon(name, centre, axes, np.array(vertices), np.array(polygons.ears(vertices)))


L_SHAPE = ((0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (1.0, 2.0), (1.0, 1.0), (0.0, 1.0))

PLATE = plate("plate")
"""A square of side 1."""
BODIES: list[ClosedFormBody] = [
    Cuboid("cuboid", CENTRE, TURNED, (0.2, 0.4, 0.6)),
    Rectangle("rectangle", CENTRE, TURNED, (0.2, 0.4)),
    Disc("disc", CENTRE, TURNED, 0.7),
    polygon("L", L_SHAPE, CENTRE, TURNED),
    Ellipsoid("ellipsoid", CENTRE, TURNED, (0.3, 0.5, 1.0)),
    Sphere("sphere", CENTRE, 0.8),
    Cylinder("cylinder", CENTRE, TURNED, 1.0, 2.0),
    Cone("cone", CENTRE, TURNED, 0.7, 2.0),
    Swept("capsule", CENTRE, TURNED, (0.0, 0.0, 0.8), 0.4),
    Swept("stadium", CENTRE, TURNED, (0.5, 0.0, 0.8), 0.4),
    Swept("rounded", CENTRE, TURNED, (0.5, 0.7, 0.8), 0.1),
    *(Arc(f"arc of {half:.1f}", CENTRE, TURNED, 1.0, 1.6, 0.8, half) for half in (0.1, 0.6, 1.7, 3.0, np.pi)),
]
"""One body of every kind with distances in closed form, or several of a kind, all in one turned frame."""


def prism(outline: Array, hole: Array | None = None) -> Array:
    """The triangles of a prism of height 1 on an outline (n, 2): with a hole of as many corners, or else one that is seen whole from its
    first corner, as an L is from the outer corner between its legs."""

    def wall(loop: Array) -> list[list[Array]]:
        low, high = (np.column_stack([loop, np.full(len(loop), z)]) for z in (0.0, 1.0))
        rest = [*range(1, len(loop)), 0]
        faces = [[low[i], low[j], high[j]] for i, j in enumerate(rest)]
        return faces + [[low[i], high[j], high[i]] for i, j in enumerate(rest)]

    if hole is None:
        flat = [outline[[0, k, k + 1]] for k in range(1, len(outline) - 1)]
    else:
        flat = []
        for i, j in enumerate([*range(1, len(outline)), 0]):
            flat += [np.array([outline[i], outline[j], hole[j]]), np.array([outline[i], hole[j], hole[i]])]
    top = [list(np.column_stack([three, np.ones(3)])) for three in flat]
    bottom = [list(np.column_stack([three, np.zeros(3)])[::-1]) for three in flat]
    walls = wall(outline) + ([] if hole is None else wall(hole[::-1]))
    return np.array(top + bottom + walls)


def semidefinite(random: np.random.Generator, size: float = 1.0) -> Array:
    """A positive semidefinite matrix (3, 3)."""
    root = random.normal(size=(3, 3))
    return np.asarray(size * root @ root.T)
