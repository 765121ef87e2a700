"""`python3 -m analysis.topics.published.upper_bound WORKS`: upper bounds of Maxwell matrices by the field solver, on one mesh each.

A continuous potential that is V_i on conductor i has at least the energy VᵀMV (fem_reference/NUMERICS.md, section 5). One mesh
is enough: however good its potentials are, their energy, integrated exactly and out to infinity, is above the truth's.
A process solves several scenes, since what it loads and compiles first takes longer than a scene.
"""

from __future__ import annotations

import json
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.constants import epsilon_0

from analysis.results.store import Document, write_json
from fem_reference.mesh.tagged_mesh import TaggedMesh, tagged_mesh
from fem_reference.bodies.conductors import Conductors, conductors
from fem_reference.mesh.size_rules import Sizing
from fem_reference.solve.field_problem import FieldProblem, release_unused
from fem_reference.bodies.symmetry import mirror_planes
from fem_reference.solve.upper_energy import upper_energies
from geometries.scene import reader

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Bound:
    """`upper` − M is positive semidefinite, `value` is the mesh's approximation of M (n, n); farads."""

    upper: Array
    value: Array
    unknowns: int
    seconds: float


def bound(scene: Path, refinement: float) -> Bound:
    """Solves a scene of grounded conductors in free space on one mesh; `refinement` divides the element sizes at the edges of the
    coarsest mesh."""
    start = time.monotonic()
    problem = conductors(reader.load(scene), str(scene))
    planes = mirror_planes(problem.bodies, problem.owner, problem.room)
    mesh = tagged_mesh(problem.bodies, problem.owner, Sizing(refinement=refinement), planes=planes)
    above, value, unknowns = _energies(problem, mesh)
    release_unused(mesh.mesh.comm)
    farads = epsilon_0 * problem.unit * mesh.copies
    return Bound(farads * above, farads * value, unknowns, time.monotonic() - start)


def _energies(problem: Conductors, mesh: TaggedMesh) -> tuple[Array, Array, int]:
    """Returns the bound, the value and the number of unknowns, of one side of the planes and for ε = 1."""
    system = FieldProblem(mesh, problem.parts)
    every = range(problem.driven)
    potentials = system.potentials(every, len(every))
    return upper_energies(system, potentials), system.energies(potentials), system.unknowns


def document(found: Bound) -> Document:
    """Returns the bound as plain data."""
    return {
        "upper": found.upper.tolist(),
        "value": found.value.tolist(),
        "unknowns": found.unknowns,
        "seconds": found.seconds,
    }


def main(text: str) -> int:
    """Solves the scenes of a JSON list of objects with `scene`, `target`, `key` and `refinement`, and stores each answer; returns
    the number of failures."""
    failed = 0
    for work in json.loads(text):
        try:
            found = bound(Path(work["scene"]), work["refinement"])
        except RuntimeError as error:
            print(f"{work['scene']}: {error}", file=sys.stderr)
            failed += 1
            continue
        write_json(Path(work["target"]), {"key": work["key"], **document(found)})
    return failed


if __name__ == "__main__":
    sys.exit(1 if main(sys.argv[1]) else 0)
