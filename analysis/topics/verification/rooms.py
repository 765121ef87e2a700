"""Plates in a grounded room, and what they are to mirror images: python3 -m analysis measure rooms makes rooms.json anew.

A grounded wall is a mirror in which the image of a charge is the opposite charge. Before one, two or three walls of a large room a plate
has one, three or seven images; between floor and ceiling it has two for every reflection. Boundary elements solve the plates
with their images in free space, so that the truth owes nothing to a mesh of space, nor to a room. The other walls are FAR away. Their
effect is that of images beyond them, which carry no charge together: below 1e-6 of an entry.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.pipeline.model_stage import model_module
from geometries.common.files import whole_file

Array = NDArray[np.float64]

ROOMS = Path(__file__).with_name("rooms.json")
FAR = 4.0
"""Metres between a plate and what is not to matter, plates being 0.1 m wide."""
PICOFARAD = 1e-12
RTOL, RTOL_OF_MANY = 2e-5, 1e-4
"""Asked of boundary elements: far below what the field reference is asked for. More than MANY plates take too long for the first."""
MANY = 16
REFLECTIONS = (8, 10)
"""Of floor and ceiling; the first number only tells how much the second leaves."""
EULER = (15 / 16, 11 / 16, 5 / 16, 1 / 16)
"""How much the charges of the last reflections count: Euler's transform of an alternating sum."""

Range = tuple[float, float]


@dataclass(frozen=True)
class PlatesInRoom:
    """Horizontal plates in a room from `low` to `high`, metres. `plates[k]` are those of conductor k: centres and half widths."""

    name: str
    low: tuple[float, float, float]
    high: tuple[float, float, float]
    plates: tuple[tuple[tuple[Array, Array], ...], ...]


def _plate(x: float, y: float, z: float, a: float = 0.05, b: float = 0.05) -> tuple[Array, Array]:
    return np.array([x, y, z]), np.array([a, b])


def rooms() -> list[PlatesInRoom]:
    """One to three near walls, with no plane of symmetry to three of them."""
    wide = (-FAR, -FAR)
    sensor, target = _plate(0, 0, 0.03), _plate(0.01, 0, 0.06, 0.03, 0.02)
    aside = _plate(0.7, 0, 0.03)
    edge = _plate(0.09, 0, 0.03), _plate(0.1, 0, 0.06, 0.03, 0.02)
    corner = _plate(0.09, 0.07, 0.03), _plate(0.1, 0.08, 0.06, 0.03, 0.02)
    diagonal = _plate(0.09, 0.09, 0.03), _plate(0.1, 0.1, 0.06, 0.03, 0.03)
    facing = (_plate(0, 0, 0.05), _plate(0, 0, 0.15))
    return [
        PlatesInRoom("a plate before a wall", (*wide, 0), (FAR, FAR, FAR), ((sensor,),)),
        PlatesInRoom("a plate before a wall, off its middle", (*wide, 0), (FAR, FAR, FAR), ((aside,),)),
        PlatesInRoom("two plates before a wall", (*wide, 0), (FAR, FAR, FAR), ((sensor,), (target,))),
        PlatesInRoom("two plates before two walls", (0, -FAR, 0), (FAR, FAR, FAR), ((edge[0],), (edge[1],))),
        PlatesInRoom("two plates before three walls", (0, 0, 0), (FAR, FAR, FAR), ((corner[0],), (corner[1],))),
        PlatesInRoom("two plates before three walls, on their diagonal", (0, 0, 0), (FAR, FAR, FAR),
                     ((diagonal[0],), (diagonal[1],))),
        PlatesInRoom("a sensor of two plates between floor and ceiling", (*wide, 0), (FAR, FAR, 0.2), (facing,)),
        PlatesInRoom("two sensors edge to edge between floor and ceiling", (*wide, 0), (FAR, FAR, 0.2),
                     ((_plate(0, 0.2, 0.08, 0.05, 0.022),), (_plate(0, 0.25, 0.08, 0.05, 0.022),))),
    ]  # fmt: skip


def images(room: PlatesInRoom, centre: Array, reflections: int) -> list[tuple[Array, float]]:
    """The images of a point in the near walls, itself first: where each is, and how much of the point's charge it has."""
    axes = []
    for low, high, x in zip(room.low, room.high, centre.tolist()):
        near = [(x, 1.0)]
        if x - low < FAR / 2 and high - x < FAR / 2:
            weights = [1.0] * (reflections - len(EULER)) + list(EULER)
            for times, weight in enumerate(weights, start=1):
                near += [
                    (_reflected(x, low, high, side * times), weight * (-1.0) ** times) for side in (-1, 1)
                ]
        elif x - low < FAR / 2:
            near.append((2 * low - x, -1.0))
        elif high - x < FAR / 2:
            near.append((2 * high - x, -1.0))
        axes.append(near)
    return [
        (np.array([place for place, _ in image]), float(np.prod([charge for _, charge in image])))
        for image in product(*axes)
    ]


def _reflected(x: float, low: float, high: float, times: int) -> float:
    """Image number `times` of x between two walls: even ones are moved by whole periods, odd ones are mirrored, too."""
    width = high - low
    return low + times * width + (x - low if times % 2 == 0 else high - x)


def maxwell(room: PlatesInRoom) -> tuple[Array, float]:
    """The Maxwell matrix (F) and the largest relative error of an entry: what boundary elements and the reflections leave."""
    before, best = (_with_images(room, reflections) for reflections in REFLECTIONS)
    return best[0], float(np.max(np.abs(best[0] - before[0]) / np.abs(best[0]))) + best[1]


def _with_images(room: PlatesInRoom, reflections: int) -> tuple[Array, float]:
    """The Maxwell matrix (F) with so many reflections, and the largest relative error of the plates' own entries.

    The potentials of all plates and images by their charges are the inverse of their Maxwell matrix. An image has the charge of its
    plate times a factor, which leaves the potentials of the plates by their own charges.
    """
    owner = [conductor for conductor, plates in enumerate(room.plates) for _ in plates]
    charged = [
        (number, place, half, factor)
        for number, (centre, half) in enumerate(plate for plates in room.plates for plate in plates)
        for place, factor in images(room, centre, reflections)
    ]
    text = [_sensor(f"plate {k}", place, half) for k, (_, place, half, _) in enumerate(charged)]
    loaded = model_module().Scene.loads("\n".join(text))
    found = loaded.maxwell(rtol=RTOL if len(charged) <= MANY else RTOL_OF_MANY)
    matrix, error = np.array(found["maxwell"]), np.array(found["error"])
    own = [[number for number, *_ in charged].index(k) for k in range(len(owner))]
    factors = np.zeros((len(charged), len(owner)))
    for k, (number, _, _, factor) in enumerate(charged):
        factors[k, number] = factor
    of_plates = np.linalg.inv((np.linalg.inv(matrix) @ factors)[own])
    joined = (np.array(owner)[:, None] == np.arange(len(room.plates))).astype(float)
    relative = np.max(error[own, own] / matrix[own, own])
    return joined.T @ of_plates @ joined, float(relative)


def _sensor(name: str, centre: Array, half: Array) -> str:
    (x, y, z), (a, b) = centre.tolist(), half.tolist()
    return (
        f'[[sensor]]\nname = "{name}"\nplates = [{{ corner = [{x - a!r}, {y - b!r}, {z!r}], '
        f"edge_u = [{2 * a!r}, 0, 0], edge_v = [0, {2 * b!r}, 0] }}]\n"
    )


def solved() -> list[dict[str, Any]]:
    """Every room with its Maxwell matrix, pF."""
    found = []
    for room in rooms():
        matrix, error = maxwell(room)
        plates = [
            [{"centre": centre.tolist(), "half_widths": half.tolist()} for centre, half in conductor]
            for conductor in room.plates
        ]
        found.append(
            {
                "name": room.name,
                "low": list(room.low),
                "high": list(room.high),
                "plates": plates,
                "maxwell_pF": (matrix / PICOFARAD).tolist(),
                "relative_error": error,
            }
        )
    return found


def measure(_: argparse.Namespace) -> int:
    """Solves every room and writes the file."""
    document = {
        "description": "Maxwell capacitance matrices (pF) of thin horizontal rectangles in a grounded room, from boundary "
        "elements of the plates and their mirror images. Made by python3 -m analysis measure rooms.",
        "cases": solved(),
    }
    with whole_file(ROOMS) as unfinished:
        unfinished.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    return 0
