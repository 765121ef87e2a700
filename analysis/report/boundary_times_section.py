"""The report's section on what boundary elements take: whole scenes, growth with the number of panels, regular polyhedra."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from markupsafe import Markup

from analysis.report import measured, page
from analysis.report.measured import Origin, origin
from analysis.results.store import Document, read_json
from analysis.results.study_results import BOUNDARY_TIMES
from analysis.results.units import duration, measured as written, percent

TITLE = "Time and memory of boundary elements"

_SCENES = (
    "Two processors, each row once, in a process of its own. The stated error is the largest of a reading's change, relative to the "
    "change; memory is the largest of the process."
)
_SIZES = (
    "A sphere of nearly equal triangles, which are the panels, solved once without refinement. The error is relative to the "
    "sphere's capacity, and contains that of the polyhedron."
)
_SOLIDS = (
    "Capacities in units of 4πε₀ times the edge. Published is the cube's by Helsing and Perfekt, On the polarizability and "
    "capacitance of the cube, 2013; of the other solids no published value was found."
)


def section(found: BoundaryTimes | None) -> Markup:
    """Returns three tables, each below its finding, and how to measure again."""
    return measured.section(TITLE, found, _parts)


def _parts(found: BoundaryTimes) -> Iterator[Markup]:
    yield page.finding(finding_on_scenes(found.scenes))
    yield from (_scenes_table(found.scenes), page.soft(_SCENES))
    yield page.finding(finding_on_sizes(found.sizes))
    yield from (_sizes_table(found.sizes), page.soft(_SIZES))
    yield page.finding(finding_on_solids(found.solids))
    yield from (_solids_table(found.solids), page.soft(_SOLIDS))
    yield measured.again(found.origin)


def load(folder: Path) -> BoundaryTimes | None:
    """Returns what was measured, in a folder of results."""
    return boundary_times(read_json(folder / BOUNDARY_TIMES))


def finding_on_scenes(scenes: Sequence[SceneTime]) -> str:
    """Tells how many scenes have the accuracy asked for, and which took longest."""
    missed = [scene.name for scene in scenes if not scene.reached]
    longest = max(scenes, key=lambda scene: scene.seconds)
    sentence = f"{len(scenes) - len(missed)} of {len(scenes)} scenes have the accuracy asked for"
    if missed:
        sentence += f", not: {'; '.join(missed)}"
    return f"{sentence}. The longest took {duration(longest.seconds, 2)}: {longest.name}."


def finding_on_sizes(sizes: Sequence[SizeTime]) -> str:
    """Compares the largest size with the one before it."""
    large = sizes[-1]
    sentence = f"{large.panels:,} panels take {duration(large.seconds, 2)} and {large.mebibytes:,.0f} MiB"
    if len(sizes) < 2:
        return f"{sentence}."
    small = sizes[-2]
    return (
        f"{sentence}: {large.panels / small.panels:.1f} times the panels take {large.seconds / small.seconds:.1f} times the time and "
        f"{large.mebibytes / small.mebibytes:.1f} times the memory."
    )


def finding_on_solids(solids: Sequence[SolidCapacity]) -> str:
    """Compares with published capacities, and gives the largest stated error."""
    worst = max(solid.stated / solid.capacity for solid in solids)
    compared = [
        f"that of the {solid.name} is {percent(abs(solid.capacity / solid.published - 1))} off the published one, "
        f"{'within' if abs(solid.capacity - solid.published) <= solid.stated else 'beyond'} its stated error"
        for solid in solids
        if solid.published is not None
    ]
    return (
        "; ".join([f"The capacities of the regular polyhedra are stated to {percent(worst)}", *compared])
        + "."
    )


def _scenes_table(scenes: Sequence[SceneTime]) -> Markup:
    return page.table_of(
        scenes,
        ("scene", lambda scene: scene.name),
        ("rtol", lambda scene: f"{scene.rtol:g}"),
        ("unknowns", lambda scene: f"{scene.unknowns:,}"),
        ("stated error", lambda scene: percent(scene.stated)),
        ("time", lambda scene: duration(scene.seconds, 2)),
        ("MiB", lambda scene: f"{scene.mebibytes:,.0f}"),
    )


def _sizes_table(sizes: Sequence[SizeTime]) -> Markup:
    return page.table_of(
        sizes,
        ("panels", lambda size: f"{size.panels:,}"),
        ("time", lambda size: duration(size.seconds, 2)),
        ("MiB", lambda size: f"{size.mebibytes:,.0f}"),
        ("error", lambda size: percent(size.error)),
        text_columns=0,
    )


def _solids_table(solids: Sequence[SolidCapacity]) -> Markup:
    return page.table_of(
        solids,
        ("solid", lambda solid: solid.name),
        ("capacity", lambda solid: written(solid.capacity, solid.stated)),
        ("published", lambda solid: "–" if solid.published is None else f"{solid.published:.8f}"),
        ("unknowns", lambda solid: f"{solid.panels:,}"),
        ("time", lambda solid: duration(solid.seconds, 2)),
    )


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
