"""What one mesh says about a scene's Maxwell matrix."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.constants import epsilon_0

from fem_reference.solve.enclosure import Enclosure, enclosure, widened
from fem_reference.solve.flux import flux_energies
from fem_reference.common.limits import peak_memory
from fem_reference.mesh.tagged_mesh import TaggedMesh, tagged_mesh
from fem_reference.bodies.conductors import Conductors
from fem_reference.mesh.sizing import Sizing
from fem_reference.solve.field_problem import Charges, FieldProblem, charges, release_unused, without_floating
from fem_reference.common.stages import stage
from fem_reference.bodies.symmetry import Plane
from fem_reference.solve.upper_energy import upper_energies

Array = NDArray[np.float64]

Bounds = Literal["none", "check", "enclosure"]
"""Whether a level is to have bounds: none, wide ones that check its values, or those that are the answer."""

FLUX_DEGREE = 3
"""Raviart–Thomas fluxes of degree 3 match the cubic potentials: on the square plate both bounds are then about as far
from the truth, at four times the time of the potentials. Degree 2 is three to four times farther off at a third of the time, degree 4
takes three times as long for two thirds of the distance."""
CHECK_DEGREE = 2
"""Degree of the fluxes that only check a level: bounds some 0.5 to 1 % wide on the coarsest one, for a tenth of the time of an
answer of three levels. Degree 1 leaves quarter-point cells with no flux at all."""


@dataclass(frozen=True)
class Level:
    """One mesh; farads, and the size of its tetrahedra at the finest body's edges in metres."""

    edge_size: float
    unknowns: int
    cells: int
    seconds: float
    maxwell: Array
    sensors_alone: Array
    delta_self: Array
    memory: int = 0
    """The most memory (bytes) the process had held when the level was done."""
    flux_seconds: float = 0.0
    """What the bounds took, of `seconds`."""
    enclosure: Enclosure | None = None
    """Where the truth lies, when asked for."""
    check: Enclosure | None = None
    """The same by coarser fluxes, of a level whose error is to be estimated: what contradicts it is wrong."""


def solve_level(
    problem: Conductors,
    relative_permittivity: float,
    sizing: Sizing,
    bounds: Bounds,
    planes: Sequence[Plane] = (),
) -> Level:
    """Mesh and solve once, on one side of planes of symmetry.

    Raises RuntimeError when the mesher or the solver fails, or when bounds are asked for and contradict each other.
    """
    start = time.monotonic()
    mesh = tagged_mesh(
        problem.bodies,
        problem.owner,
        sizing,
        dielectrics=problem.permittivities,
        planes=planes,
        room=problem.room,
    )
    farads = epsilon_0 * relative_permittivity * problem.unit * mesh.copies
    found, done, interval = _answers(problem, mesh, farads, bounds)
    release_unused(mesh.mesh.comm)
    smallest = min(body.size for body in problem.bodies)
    end = time.monotonic()
    return Level(
        sizing.edge * smallest * problem.unit / sizing.refinement,
        found.unknowns,
        mesh.cell_count,
        end - start,
        farads * found.maxwell,
        farads * found.sensors_alone,
        farads * np.diag(found.maxwell[: problem.sensors, : problem.sensors] - found.sensors_alone),
        peak_memory(),
        end - done,
        interval if bounds == "enclosure" else None,
        interval if bounds == "check" else None,
    )


def _answers(
    problem: Conductors, mesh: TaggedMesh, farads: float, bounds: Bounds
) -> tuple[Charges, float, Enclosure | None]:
    """The charges, when they were known, and where they lie when that is asked for. Refers to no matrix any more."""
    system = FieldProblem(mesh, problem.parts, problem.permittivities)
    found = charges(
        system, problem.sensors, len(problem.floating), len(problem.grounded), problem.grounded_sensors
    )
    done = time.monotonic()
    if bounds == "none":
        return found, done, None
    degree = FLUX_DEGREE if bounds == "enclosure" else CHECK_DEGREE
    with stage("bounding the energies"):
        return found, done, _enclosure(problem, system, found.potentials, farads, degree)


def _enclosure(
    problem: Conductors, system: FieldProblem, potentials: list[Array], farads: float, degree: int
) -> Enclosure:
    """Where the matrix lies; eliminating floating conductors keeps the order of the two bounds (NUMERICS.md section 5)."""
    above = upper_energies(system, potentials)
    flux = flux_energies(system.tagged, problem.parts, problem.driven, degree, problem.permittivities)
    below = flux.lower - np.diag(flux.algebraic_error)
    floating = len(problem.floating)
    interval = enclosure(
        farads * without_floating(below, floating), farads * without_floating(above, floating)
    )
    return widened(interval, system.tagged.shape_error)
