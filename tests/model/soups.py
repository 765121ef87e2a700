"""Random conductors as machines have them: boxes that touch or overlap, meshes with defects; each beside a clean conductor.

`random_case` makes a conductor twice, clean and as a soup. The solid is a union of boxes on a grid, of boxes that cross at any angle, or a
few loose triangles. The soup has the same surface on the outside, less of it, or more. In the first case both have the same Maxwell
matrix. In the others one charge distribution is allowed on a subset of the other's surface (or of the solid within it), and the matrix of the smaller conductor
is below that of the larger one: their difference is positive semidefinite.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from geometries.common.arrays import Array, Flags
from tests import scenes

Random = np.random.Generator

SLIVER = 1e-6
"""Height of a sliver relative to its longest side."""
JITTER = 1e-9
"""Distance (metres) by which corners are moved, above what is taken for rounding of a mesh of some centimetres."""

MOST_TRIANGLES = 1000
"""Meshes with more get no further defects, so that a scene takes seconds."""


class Relation(Enum):
    """What the soup's conductor is, compared with the clean one."""

    SAME = "same"
    LESS = "less"
    MORE = "more"


@dataclass(frozen=True)
class Box:
    """A box between two corners (metres), written as a cuboid."""

    low: Array
    high: Array

    def triangles(self) -> Array:
        """The twelve triangles, anticlockwise seen from outside."""
        corners = np.array(
            [[(self.low, self.high)[k >> axis & 1][axis] for axis in range(3)] for k in range(8)]
        )
        quads = np.array([(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)])
        return corners[np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])]

    def point(self, random: Random) -> Array:
        return random.uniform(self.low, self.high)


Part = Box | Array
"""A box, or a mesh's triangles: corners of shape (n, 3, 3) in metres."""
Parts = list[Part]


@dataclass(frozen=True)
class Solid:
    """A union of boxes: convex pieces of it, and its clean surface."""

    boxes: list[Box]
    surface: Parts


@dataclass(frozen=True)
class Case:
    """Two conductors, how their matrices are related, and what was done to make the second."""

    clean: Parts
    soup: Parts
    relation: Relation
    kinds: tuple[str, ...]


def triangles_of(part: Part) -> Array:
    return part.triangles() if isinstance(part, Box) else part


# Solids.


def grid_solid(random: Random) -> tuple[Solid, str, Parts]:
    """A union of cells of a grid of unequal spacings, the name of one way to put it together, and its parts in that way."""
    shape = random.integers(1, 4, 3)
    lines = [np.concatenate([[0.0], np.cumsum(_lengths(random, n))]) for n in shape]
    is_filled = np.zeros(shape, dtype=bool)
    is_filled[tuple(random.integers(0, shape))] = True
    for _ in range(random.integers(0, 7)):
        # A new cell has a face, or rarely only an edge, in common with one that is there.
        step = np.zeros(3, dtype=int)
        step[random.choice(3, 1 if random.random() < 0.9 else 2, replace=False)] = random.choice([-1, 1])
        cells = np.argwhere(is_filled)
        cell = cells[random.integers(len(cells))] + step
        if np.all(cell >= 0) and np.all(cell < shape):
            is_filled[tuple(cell)] = True
    filled = np.argwhere(is_filled)
    touching = [_box_of_cells(lines, cell, cell) for cell in filled]
    overlapping = []
    for cell in filled:
        # The box covers one cell or two; its neighbour has a box of its own, too.
        near = filled[np.abs(filled - cell).sum(axis=1) <= 1]
        overlapping.append(_box_of_cells(lines, cell, near[random.integers(len(near))]))
    solid = Solid(overlapping, [_grid_surface(random, is_filled, lines)])
    ways: dict[str, Parts] = {
        "clean mesh": solid.surface,
        "touching boxes": list(touching),
        "overlapping boxes": list(overlapping),
        "touching boxes in a mesh": [np.concatenate([box.triangles() for box in touching])],
        "overlapping boxes in a mesh": [np.concatenate([box.triangles() for box in overlapping])],
    }
    name = str(random.choice(list(ways)))
    return solid, name, ways[name]


def crossing_solid(random: Random) -> tuple[Solid, str, Parts]:
    """Boxes that cross at any angle: their clean surface is not known, but the boxes one by one have the same charge as in one mesh."""
    boxes: Parts = [_box_around(random, np.zeros(3))]
    inner = boxes[0]
    assert isinstance(inner, Box)
    for _ in range(random.integers(1, 4)):
        turned = Rotation.from_rotvec(random.normal(size=3)).as_matrix()
        boxes.append(_box_around(random, np.zeros(3)).triangles() @ turned.T + inner.point(random))
    mesh = np.concatenate([triangles_of(box) for box in boxes])
    return Solid([inner], boxes), "crossing boxes in a mesh", [mesh]


def loose_triangles(random: Random) -> tuple[Solid, str, Parts]:
    """Open triangles that cross each other in a small box."""
    box = _box_around(random, np.zeros(3))
    loose = np.array([[box.point(random) for _ in range(3)] for _ in range(random.integers(3, 12))])
    return Solid([], [loose]), "loose triangles", [loose]


def _lengths(random: Random, count: int) -> Array:
    return np.exp(random.uniform(np.log(0.004), np.log(0.025), count))


def _box_around(random: Random, centre: Array) -> Box:
    half = _lengths(random, 3)
    return Box(centre - half, centre + half)


def _box_of_cells(lines: list[Array], cell: NDArray[np.int_], other: NDArray[np.int_]) -> Box:
    """The box around two cells of a grid."""
    low, high = np.minimum(cell, other), np.maximum(cell, other) + 1
    corners = [np.array([line[k] for line, k in zip(lines, at, strict=True)]) for at in (low, high)]
    return Box(corners[0], corners[1])


def _grid_surface(random: Random, is_filled: Flags, lines: list[Array]) -> Array:
    """The faces between filled and empty cells, each as two triangles, anticlockwise seen from outside."""
    padded = np.pad(is_filled, 1)
    triangles = []
    for cell in np.argwhere(is_filled):
        for axis in range(3):
            for side in (0, 1):
                if padded[tuple(cell + 1 + (2 * side - 1) * np.eye(3, dtype=int)[axis])]:
                    continue
                u, v = (axis + 1) % 3, (axis + 2) % 3
                quad = np.empty((4, 3))
                quad[:, axis] = lines[axis][cell[axis] + side]
                quad[:, u] = lines[u][cell[u] + np.array([0, 1, 1, 0])]
                quad[:, v] = lines[v][cell[v] + np.array([0, 0, 1, 1])]
                quad = np.roll(quad if side else quad[::-1], random.integers(2), axis=0)
                triangles += [quad[[0, 1, 2]], quad[[0, 2, 3]]]
    return np.array(triangles)


# Defects that leave the union as it is.


def _chosen(random: Random, triangles: Array) -> Flags:
    return random.random(len(triangles)) < random.choice([0.1, 0.3, 1.0])


def flipped(random: Random, triangles: Array) -> Array:
    """Every third triangle clockwise."""
    result = triangles.copy()
    result[::3] = result[::3, ::-1]
    return result


def duplicated(random: Random, triangles: Array) -> Array:
    """Some triangles twice or three times, with their corners in any order."""
    copies = [triangles]
    for _ in range(random.integers(1, 3)):
        copies += [
            triangle[random.permutation(3)][None] for triangle in triangles[_chosen(random, triangles)]
        ]
    return np.concatenate(copies)


def with_t_junctions(random: Random, triangles: Array) -> Array:
    """Some triangles halved, their neighbours not."""

    def halves(a: Array, b: Array, c: Array) -> list[Array]:
        between = a + random.choice([0.5, random.uniform(0.02, 0.98)]) * (b - a)
        return [np.array([a, between, c]), np.array([between, b, c])]

    return _some_replaced(random, triangles, halves)


def split_into_slivers(random: Random, triangles: Array) -> Array:
    """Some triangles split at a point next to a side, so that one of three parts is a sliver."""

    def thirds(a: Array, b: Array, c: Array) -> list[Array]:
        foot = a + random.uniform(0.1, 0.9) * (b - a)
        near = foot + SLIVER * (c - foot)
        return [np.array([a, b, near]), np.array([b, c, near]), np.array([c, a, near])]

    return _some_replaced(random, triangles, thirds)


def _some_replaced(
    random: Random, triangles: Array, parts: Callable[[Array, Array, Array], list[Array]]
) -> Array:
    """Replaces some triangles by their parts, which begin at any of their corners."""
    result: list[Array] = []
    for triangle, is_split in zip(triangles, _chosen(random, triangles)):
        result += parts(*np.roll(triangle, random.integers(3), axis=0)) if is_split else [triangle]
    return np.array(result)


def with_touching_plates(random: Random, triangles: Array) -> Array:
    """Triangles that lie on others, in their planes; some of them are slivers or have no area."""
    added = []
    for triangle in triangles[_chosen(random, triangles)]:
        start, end, top = (_on(random, *triangle) for _ in range(3))
        middle = (start + end) / 2
        added.append([start, end, middle + random.choice([1.0, SLIVER, 0.0]) * (top - middle)])
    return np.concatenate([triangles, np.array(added).reshape(-1, 3, 3)])


def subdivided(random: Random, triangles: Array) -> Array:
    """All triangles in quarters, as often as a thousand allow."""
    while len(triangles) < 250:
        middle = (triangles + np.roll(triangles, -1, axis=1)) / 2
        corner = [np.stack([triangles[:, k], middle[:, k], middle[:, k - 1]], axis=1) for k in range(3)]
        triangles = np.concatenate([*corner, middle])
    return triangles


def shuffled(random: Random, triangles: Array) -> Array:
    """The triangles in another order."""
    return triangles[random.permutation(len(triangles))]


def jittered(random: Random, triangles: Array) -> Array:
    """Corners that do not quite meet."""
    return triangles + random.uniform(-JITTER, JITTER, triangles.shape)


def _on(random: Random, a: Array, b: Array, c: Array) -> Array:
    """A random point of a triangle."""
    weights = random.dirichlet([1, 1, 1])
    return np.asarray(weights @ np.array([a, b, c]))


OF_MESHES: tuple[Callable[[Random, Array], Array], ...] = (
    flipped,
    duplicated,
    with_t_junctions,
    split_into_slivers,
    with_touching_plates,
    subdivided,
    shuffled,
    jittered,
)


# Parts inside the solid.


def inner_boxes(random: Random, solid: Solid) -> Parts:
    """Boxes in the solid, which may hold or cross each other, face inwards, and touch the surface from inside."""
    parts: Parts = []
    room = solid.boxes[random.integers(len(solid.boxes))]
    for _ in range(random.integers(1, 4)):
        ends = np.sort([room.point(random), room.point(random)], axis=0)
        is_wide = random.random((2, 3)) < 0.2
        low, high = np.where(is_wide[0], room.low, ends[0]), np.where(is_wide[1], room.high, ends[1])
        box = Box(low, high)
        parts.append(box if random.random() < 0.5 else box.triangles()[:, ::-1])
    return parts


def inner_sheets(random: Random, solid: Solid) -> Parts:
    """Triangles inside the solid, with corners that may lie on its surface."""
    room = solid.boxes[random.integers(len(solid.boxes))]
    corners = np.array([room.point(random) for _ in range(3 * random.integers(1, 8))])
    for corner in corners[random.random(len(corners)) < 0.3]:
        axis = random.integers(3)
        corner[axis] = (room.low, room.high)[random.integers(2)][axis]
    return [corners.reshape(-1, 3, 3)]


INSIDE: tuple[Callable[[Random, Solid], Parts], ...] = (inner_boxes, inner_sheets)


# Changes of the union.


def with_holes(random: Random, parts: Parts) -> Parts:
    """The parts without a share of their triangles."""
    share = random.choice([0.05, 0.2, 0.6])
    holed = [triangles_of(part) for part in parts]
    holed = [part[random.random(len(part)) >= share] for part in holed]
    return [part for part in holed if len(part) > 0] or [triangles_of(parts[0])]


def with_outgrowths(random: Random, parts: Parts) -> Parts:
    """The parts, and triangles and a box that cross them and stick out."""
    surface = np.concatenate([triangles_of(part) for part in parts])
    size = float(np.ptp(surface.reshape(-1, 3), axis=0).max())
    added = []
    for _ in range(random.integers(1, 6)):
        start = _on(random, *surface[random.integers(len(surface))])
        added.append(start + random.uniform(-0.5, 0.5, (3, 3)) * size)
        added[-1][0] = start
    grown: Parts = [*parts, np.array(added)]
    if random.random() < 0.3:
        grown.append(_box_around(random, _on(random, *surface[random.integers(len(surface))])))
    return grown


# Cases.


def random_case(random: Random) -> Case:
    """A clean conductor and a soup of it with up to four kinds of defects."""
    make = (grid_solid, crossing_solid, loose_triangles)[random.choice(3, p=[0.7, 0.2, 0.1])]
    solid, name, parts = make(random)
    kinds = [name]
    for _ in range(random.integers(0, 5)):
        if solid.boxes and random.random() < 0.35:
            inside = INSIDE[random.integers(len(INSIDE))]
            kinds.append(inside.__name__)
            added = inside(random, solid)
            if random.random() < 0.5:
                parts = [*parts, *added]
            else:
                chosen = int(random.integers(len(parts)))
                mesh = np.concatenate([triangles_of(part) for part in (parts[chosen], *added)])
                parts = [*parts[:chosen], mesh, *parts[chosen + 1 :]]
        elif sum(len(triangles_of(part)) for part in parts) <= MOST_TRIANGLES:
            change = OF_MESHES[random.integers(len(OF_MESHES))]
            kinds.append(change.__name__)
            is_changed = random.random(len(parts)) < 0.7
            is_changed[random.integers(len(parts))] = True
            parts = [
                change(random, triangles_of(part)) if is_it else part
                for part, is_it in zip(parts, is_changed)
            ]
    relation = (Relation.SAME, Relation.LESS, Relation.MORE)[random.choice(3, p=[0.7, 0.15, 0.15])]
    if relation is not Relation.SAME:
        parts = (with_holes if relation is Relation.LESS else with_outgrowths)(random, parts)
        kinds.append("holes" if relation is Relation.LESS else "outgrowths")
    order = random.permutation(len(parts))
    return Case(solid.surface, [parts[k] for k in order], relation, tuple(kinds))


def written(case: Case, random: Random, folder: Path) -> tuple[Path, Path]:
    """Writes the scenes of the clean conductor and of the soup above the same square sensor; returns their paths.

    The conductor is turned at random and may be grounded, floating or an electrode. Soups of several parts that need not touch exactly, or
    are not grounded, have the name of their conductor.
    """
    rotation = Rotation.from_rotvec(random.normal(size=3) * (random.random() < 0.7))
    points = np.concatenate([triangles_of(part).reshape(-1, 3) for part in (*case.clean, *case.soup)])
    placed = points @ rotation.as_matrix().T
    gap = np.exp(random.uniform(np.log(0.002), np.log(0.03)))
    shift = -(placed.min(axis=0) + placed.max(axis=0)) / 2
    shift[:2] += random.uniform(-0.02, 0.02, 2)
    shift[2] = gap - placed[:, 2].min()
    side = random.uniform(0.03, 0.1)
    potential = str(random.choice(["grounded", "electrode", "floating"], p=[0.7, 0.15, 0.15]))
    needs_name = "jittered" in case.kinds or case.kinds[0] == "loose triangles"
    is_named = (
        needs_name or case.relation is not Relation.SAME or potential != "grounded" or random.random() < 0.3
    )
    conductor = {"conductor": "body"} if is_named else {}
    paths = []
    for name, parts in (("clean", case.clean), ("soup", case.soup)):
        text = scenes.sensor("sensor", [[-side / 2, -side / 2, 0], [side, 0, 0], [0, side, 0]])
        text += scenes.link(
            "body", translation=shift.tolist(), quaternion=np.roll(rotation.as_quat(), 1).tolist()
        )
        for k, part in enumerate(parts):
            if isinstance(part, Box):
                centre = (part.low + part.high) / 2
                kind, keys = "cuboid", {
                    "size": (part.high - part.low).tolist(),
                    "translation": centre.tolist(),
                }
            else:
                kind, keys = "mesh", {"file": f"{name}_{k}.obj"}
                (folder / f"{name}_{k}.obj").write_text(scenes.obj(part))
            text += scenes.body(f"{name} {k}", kind, link="body", potential=potential, **conductor, **keys)
        paths.append(folder / f"{name}.toml")
        paths[-1].write_text(text)
    return paths[0], paths[1]
