"""Work for a tenth of the first enclosure's width, by adapted meshes and by halved sizes: python3 -m analysis measure widths [NAME …].

The command solves the set-ups named, or those without an answer, and writes `widths.json`, which the verification's page shows.
"""

from __future__ import annotations

import argparse
import json
import logging
import time
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from analysis.results.store import Document, write_text
from fem_reference.bodies.conductors import Conductors
from fem_reference.bodies.symmetry import mirror_planes
from fem_reference.mesh.size_rules import Sizing, enclosed_growth, sizing_for
from geometries.common.errors import InputError

ANSWERS = Path(__file__).with_name("widths.json")
NAMES = (
    "square plate",
    "cube",
    "cylinder",
    "coaxial discs, gap/radius 0.5",
    "parallel squares, gap/side 0.1",
    "parallel squares, gap/side 0.5",
    "parallel 10x10 gap3",
    "size 3x3 on 10x10 gap1.5",
    "a plate before a wall",
    "a sensor of two plates between floor and ceiling",
    "two plates before three walls, on their diagonal",
)
"""Set-ups of the verification whose first mesh has less than 15,000 unknowns, so that a tenth of the width takes halved sizes no more than minutes."""
FRACTION = 0.1
"""Width asked for, over that on the first mesh."""
MOST_UNKNOWNS = 150_000
"""No mesh of halved sizes follows one of more unknowns than half of this."""


def work(name: str) -> Document:
    """Solves a set-up in both ways, without sensors, so that only the entries of the matrix count.

    Each mesh has its unknowns, the processor seconds until its end, and half the width of the widest entry over the entry.
    """
    from fem_reference.answer.reference import solve_conductors

    from analysis.topics.verification.set_ups import true_cases

    problem = replace(true_cases()[name].set_up, sensors=0).conductors()
    (first,) = _meshes(problem, [Sizing(growth=enclosed_growth(1.0))], 0.0)
    goal = FRACTION * first["width"]
    meshes: list[Document] = []
    start = time.process_time()
    solve_conductors(
        problem,
        rtol=goal,
        progress=lambda answer: meshes.append(
            {
                "unknowns": answer.levels[-1].unknowns,
                "seconds": time.process_time() - start,
                "width": answer.worst,
            }
        ),
    )
    return {"goal": goal, "adapted": meshes, "halved": list(_meshes(problem, _halved(goal), goal))}


def _halved(goal: float) -> Iterator[Sizing]:
    """The sizes of the meshes of an enclosure before meshes were adapted."""
    for halvings in range(8):
        yield sizing_for(goal, 2.0**halvings)


def _meshes(problem: Conductors, sizings: Iterable[Sizing], goal: float) -> Iterator[Document]:
    """Encloses the matrix on one mesh after the other, down to a width."""
    from fem_reference.solve.level import solve_level

    planes = mirror_planes(problem.bodies, problem.owner, problem.room)
    start = time.process_time()
    for sizing in sizings:
        level = solve_level(problem, 1.0, sizing, "enclosure", planes)
        assert level.enclosure is not None
        width = float(np.max(level.enclosure.half_width / np.abs(level.maxwell)))
        yield {
            "unknowns": level.unknowns,
            "seconds": time.process_time() - start,
            "width": width,
        }
        if width <= goal or level.unknowns > MOST_UNKNOWNS / 2:
            return


def stored() -> dict[str, Document]:
    """The answers by the names of their set-ups."""
    if not ANSWERS.is_file():
        return {}
    found: dict[str, Document] = json.loads(ANSWERS.read_text(encoding="utf-8"))
    return found


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the set-ups."""
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"set-ups to solve anew: {'; '.join(NAMES)}")


def measure(options: argparse.Namespace) -> int:
    """Solves set-ups and writes the file; returns the exit status."""
    unknown = [name for name in options.names if name not in NAMES]
    if unknown:
        raise InputError("", "", f"no set-up is called {unknown[0]!r}; there are {'; '.join(NAMES)}")
    # The form compiler logs through the root logger.
    logging.disable(logging.INFO)
    for name in options.names or [name for name in NAMES if name not in stored()]:
        answers = {**stored(), name: work(name)}
        ordered = {each: answers[each] for each in NAMES if each in answers}
        write_text(ANSWERS, json.dumps(ordered, indent=1) + "\n")
    return 0
