"""The potential with the first sensor at 1 V, for pictures: solved on the coarsest mesh, with straight tetrahedra."""

from __future__ import annotations

from dolfinx import fem

from fem_reference.mesh.tagged_mesh import TaggedMesh, tagged_mesh
from fem_reference.bodies.conductors import Conductors
from fem_reference.mesh.sizing import Sizing
from fem_reference.solve.field_problem import FieldProblem, first_sensor_driven


def driven_sensor(problem: Conductors) -> tuple[TaggedMesh, fem.Function]:
    """The mesh, and the potential with every other conductor grounded or, if it is floating, uncharged.

    Raises RuntimeError when the mesher or the solver fails.
    """
    tagged = tagged_mesh(
        problem.bodies,
        problem.owner,
        Sizing(),
        straight=True,
        dielectrics=problem.permittivities,
        room=problem.room,
    )
    system = FieldProblem(tagged, problem.parts, problem.permittivities, problem.to_ground)
    potential = fem.Function(system.space)
    potential.x.array[:] = first_sensor_driven(system, len(problem.floating))
    return tagged, potential
