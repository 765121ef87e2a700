"""Measurements of boundary elements: times and memory of whole scenes, their growth with the panels, capacities of regular polyhedra."""

from __future__ import annotations

from dataclasses import dataclass

from analysis.results.measurements import Origin, origin
from analysis.results.store import Document


@dataclass(frozen=True)
class SceneTime:
    """One scene. `stated` is the largest stated error of a reading's change, relative to the change; `reached` tells whether all entries
    that were asked for have the accuracy `rtol`."""

    name: str
    rtol: float
    unknowns: int
    stated: float
    reached: bool
    seconds: float
    mebibytes: float


@dataclass(frozen=True)
class SizeTime:
    """A sphere of so many panels, solved as they are; `error` is relative to the sphere's capacity."""

    panels: int
    seconds: float
    mebibytes: float
    error: float


@dataclass(frozen=True)
class SolidCapacity:
    """The capacity of a polyhedron with edges of 1 in units of 4πε₀ with its stated error, and the published one where there is one."""

    name: str
    capacity: float
    stated: float
    published: float | None
    panels: int
    seconds: float
    mebibytes: float


@dataclass(frozen=True)
class BoundaryTimes:
    """All measurements, in the benchmark's order."""

    origin: Origin
    scenes: tuple[SceneTime, ...]
    sizes: tuple[SizeTime, ...]
    solids: tuple[SolidCapacity, ...]


def boundary_times(document: Document | None) -> BoundaryTimes | None:
    """Returns the measurements in a stored answer of the benchmark; None without one."""
    if document is None:
        return None
    answer = document["answer"]
    return BoundaryTimes(
        origin(document),
        tuple(SceneTime(**entry) for entry in answer["scenes"]),
        tuple(SizeTime(**entry) for entry in answer["sizes"]),
        tuple(SolidCapacity(**entry) for entry in answer["solids"]),
    )
