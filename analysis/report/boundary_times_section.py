"""The report's section on what boundary elements take: whole scenes, growth with the number of panels, regular polyhedra."""

from __future__ import annotations

from collections.abc import Sequence

from markupsafe import Markup

from analysis.report import page
from analysis.results import measurements
from analysis.results.boundary_measurements import BoundaryTimes, SceneTime, SizeTime, SolidCapacity
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


def section(measured: BoundaryTimes | None) -> Markup:
    """Returns three tables, each below its finding, and how to measure again."""
    if measured is None:
        return page.section(TITLE, page.paragraph(measurements.NOT_MEASURED))
    origin = measured.origin
    return page.section(
        TITLE,
        page.finding(finding_on_scenes(measured.scenes)),
        _scenes_table(measured.scenes),
        page.soft(_SCENES),
        page.finding(finding_on_sizes(measured.sizes)),
        _sizes_table(measured.sizes),
        page.soft(_SIZES),
        page.finding(finding_on_solids(measured.solids)),
        _solids_table(measured.solids),
        page.soft(_SOLIDS),
        page.soft(
            f"{origin.processor} with {origin.instruction_sets}. Again, from the project's folder: {origin.command}"
        ),
    )


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
