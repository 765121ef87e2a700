"""Draws a set-up: the two plates in space, and the potential in the plane through their centres."""

from collections.abc import Iterable

import numpy as np
import plotly.graph_objects as go

from analysis.pipeline.model_stage import model_module
from analysis.report.plot import INK, MACHINE_COLOUR, SENSOR_COLOUR, TARGET_COLOUR, Panel, axis, figure
from analysis.results.store import Document
from analysis.results.study_results import CaseResult
from analysis.results.units import CENTIMETRE, VACUUM_PERMITTIVITY
from geometries.common.arrays import Array, Indices
from geometries.scene.poses import Transform
from geometries.scene.readings import targets
from geometries.scene.scene import Object, Scene

_FEMTOFARAD = 1e-15
_PIECES = 24
"""Parts of a scene's longest side that no edge of a coloured piece exceeds: finer than the eye distinguishes in a figure of half a page."""
_DIGITS = 2
_MOST = 6000
"""Triangles above which surfaces are shown as they are, so that a page stays small."""


def cut(corners: Array, longest: float) -> Array:
    """Bisects the longest edges of triangles (n, 3, 3) until none is longer than `longest`."""
    while True:
        edges = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
        long = edges.max(axis=1) > longest
        if not long.any():
            return corners
        own, first = corners[long], edges[long].argmax(axis=1)
        rows = np.arange(len(own))
        a, b, c = (own[rows, (first + step) % 3] for step in range(3))
        middle = (a + b) / 2
        halves = [np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)]
        corners = np.concatenate([corners[~long], *halves])


def coloured(scene: Scene) -> Panel:
    """Returns a scene's bodies in space, targets coloured by capacitance to the first sensor per area (fF/cm²), ε/d in the model.
    Needs the module fringe; ModuleNotFoundError without it."""
    module, sensor = model_module(), scene.sensors[0]
    bodies = triangles(scene)
    hit = {body.name for body, target in zip(scene.objects, targets(scene)) if target}
    everything = np.concatenate(list(bodies.values())).reshape(-1, 3)
    longest = float(np.ptp(everything, axis=0).max()) / _PIECES
    traces: list[object] = []
    for name, own in bodies.items():
        if name not in hit:
            traces.append(mesh(name, own, color=colours(scene, SENSOR_COLOUR)[name]))
            continue
        pieces = cut(own, longest) if len(own) < _MOST else own
        added = np.zeros(len(pieces))
        for corner, edge_u, edge_v in scene.sensor_rectangles(sensor.name):
            added += module.plate_integral(pieces, corner, edge_u, edge_v)
        permittivity = VACUUM_PERMITTIVITY * scene.medium.relative_permittivity
        density = permittivity * added / areas(pieces) * CENTIMETRE**2 / _FEMTOFARAD
        looks = {"colorscale": "YlOrRd", "colorbar": {"title": "fF/cm²", "thickness": 12}, "cmin": 0}
        # Parts in contact have no finite value.
        looks["cmax"] = density[np.isfinite(density)].max(initial=0.0)
        traces.append(mesh(name, pieces, intensity=density.round(_DIGITS), intensitymode="cell", **looks))
    share = f" to {sensor.name}" if scene.sensors[1:] else ""
    machine = ", machine (grey)" if len(hit) < len(scene.objects) else ""
    caption = f"sensor (blue){machine}, and what each part of the target adds{share} by the model (fF/cm²)"
    return Panel(caption, figure_in_space(traces, bodies))


def areas(corners: Array) -> Array:
    """Returns the areas (n,) of triangles (n, 3, 3)."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(np.linalg.norm(normals, axis=1) / 2)


_DECIMALS = 4
"""Decimals of a coordinate in cm: a micrometre."""
_MOST_TICKS, _FEWEST_TICKS, _SHORT = 6, 3, 0.35
"""Numbers along an axis, fewer where the side of the box is shorter than this part of the longest."""

EYE = (1.1, -1.55, 1.0)
"""Where a scene is seen from, relative to its centre."""
FLATTEST = 0.1
"""Least height of the box around a scene, relative to its largest side; plates in one plane have no height."""


def panels(case: CaseResult) -> list[Panel]:
    """Returns the case in space, and the potential around it where there is a slice of it."""
    found = [in_space(case.scene)]
    if case.slice is not None:
        first, *others = case.scene.sensors
        roles = [f"{sensor.name} grounded" for sensor in others]
        roles += [f"{body.name} {_role(body)}" for body in case.scene.objects]
        centres = "both" if len(roles) == 1 else "the"
        caption = f"potential (V) in the vertical plane through {centres} centres: {first.name} (black) at 1 V, {', '.join(roles)}"
        found.append(Panel(caption, _slice(case, case.slice)))
    return found


def _role(body: Object) -> str:
    """Returns what a body is while the first sensor alone is driven."""
    if body.relative_permittivity is not None:
        return "dielectric"
    return "grounded" if body.potential == "electrode" else body.potential


def triangles(scene: Scene) -> dict[str, Array]:
    """Names → triangles (n, 3, 3) in the world frame: the sensors', then those of all objects, dielectric ones too."""
    conductors = scene.conductors()
    found = {sensor.name: conductors[sensor.name] for sensor in scene.sensors}
    for body in scene.objects:
        found[body.name] = Transform(*scene.pose_of_object(body.name)).points(body.shape.triangles())
    return found


def aspect(bodies: Iterable[Array]) -> list[float]:
    """Returns the sides of the box around triangles (n, 3, 3) relative to the largest; none below FLATTEST."""
    extent = np.ptp(np.concatenate([own.reshape(-1, 3) for own in bodies]), axis=0)
    sides: list[float] = np.maximum(extent / extent.max(), FLATTEST).tolist()
    return sides


def in_space(scene: Scene) -> Panel:
    """Returns a scene's sensors and objects in space."""
    parts = ["sensor" if len(scene.sensors) == 1 else "sensors"]
    if scene.objects:
        parts = [f"{parts[0]} (blue)", "target (orange)"]
    if not all(targets(scene)):
        parts.append("machine (grey)")
    caption = " and ".join((", ".join(parts[:-1]), parts[-1])) if parts[1:] else parts[0]
    colour_of, bodies = colours(scene, SENSOR_COLOUR), triangles(scene)
    traces = [mesh(name, own, color=colour_of[name], opacity=0.75) for name, own in bodies.items()]
    return Panel(caption, figure_in_space(traces, bodies))


def colours(scene: Scene, sensor: str) -> dict[str, str]:
    """Returns the colour of every sensor, which is given, and of every object."""
    found = {each.name: sensor for each in scene.sensors}
    for body, target in zip(scene.objects, targets(scene)):
        found[body.name] = TARGET_COLOUR if target else MACHINE_COLOUR
    return found


def indexed(own: Array) -> tuple[Array, Indices]:
    """Returns the distinct vertices (p, 3) of triangles (n, 3, 3) in cm, and three of their indices for each triangle (n, 3)."""
    vertices = np.round(own.reshape(-1, 3) / CENTIMETRE, _DECIMALS) + 0.0
    distinct, numbers = np.unique(vertices, axis=0, return_inverse=True)
    return distinct, numbers.reshape(-1, 3)


def mesh(name: str, own: Array, **look: object) -> go.Mesh3d:
    """Returns triangles (n, 3, 3) as a body of a figure in space."""
    (x, y, z), (i, j, k) = (each.T for each in indexed(own))
    return go.Mesh3d(x=x, y=y, z=z, i=i, j=j, k=k, name=name, hoverinfo="name", flatshading=True, **look)


def figure_in_space(traces: list[object], bodies: dict[str, Array]) -> go.Figure:
    """Returns a figure of bodies, whose triangles (n, 3, 3) give the sides of the box around it. Short sides have fewer numbers, which would
    cover each other."""
    sides = aspect(bodies.values())
    view: dict[str, object] = {
        f"{axis}axis": {"title": f"{axis} (cm)", "nticks": _MOST_TICKS if side > _SHORT else _FEWEST_TICKS}
        for axis, side in zip("xyz", sides)
    }
    view |= {"aspectmode": "manual", "aspectratio": dict(zip("xyz", sides))}
    view["camera"] = {"eye": dict(zip("xyz", EYE))}
    return figure(traces, {}, {}, height=420, scene=view, margin={"l": 0, "r": 0, "t": 0, "b": 0})


def _slice(case: CaseResult, slice_of: Document) -> go.Figure:
    along, z = np.array(slice_of["along"]) / CENTIMETRE, np.array(slice_of["z"]) / CENTIMETRE
    potential = np.array(slice_of["potential"], dtype=np.float64)
    filled = go.Contour(
        x=along,
        y=z,
        z=np.round(potential, 3),
        zmin=0,
        zmax=1,
        contours={"start": 0, "end": 1, "size": 0.05},
        line={"width": 0.5},
        colorscale="Blues",
        colorbar={"title": "V", "thickness": 12},
        hovertemplate="along %{x:.3g} cm, z %{y:.3g} cm: %{z:.3f} V<extra></extra>",
    )
    traces = [filled, *_cuts(case, np.array(slice_of["origin"]), np.array(slice_of["direction"]))]
    upwards = axis("z (cm)", scaleanchor="x", constrain="domain")
    return figure(traces, axis("along the plane (cm)", constrain="domain"), upwards, height=420)


def _cuts(case: CaseResult, origin: Array, direction: Array) -> list[go.Scatter]:
    """Returns the lines in which the conductors' triangles intersect the plane."""
    colour_of = colours(case.scene, INK)
    across_plane = np.array([-direction[1], direction[0]])
    traces = []
    for name, own in triangles(case.scene).items():
        horizontal = own[..., :2] - origin
        local = np.stack([horizontal @ direction, horizontal @ across_plane, own[..., 2]], axis=-1)
        along: list[float | None] = []
        upwards: list[float | None] = []
        for triangle in local:
            crossings = _crossings(triangle)
            if len(crossings) >= 2:
                ends = np.array([min(crossings), max(crossings)]) / CENTIMETRE
                along += [ends[0, 0], ends[1, 0], None]
                upwards += [ends[0, 1], ends[1, 1], None]
        line = {"color": colour_of[name], "width": 4}
        traces.append(go.Scatter(x=along, y=upwards, mode="lines", line=line, name=name, hoverinfo="name"))
    return traces


def _crossings(triangle: Array) -> list[tuple[float, float]]:
    """Returns (along, z) where the edges of a triangle (along, across, z) meet the plane across = 0."""
    found = []
    for start, end in zip(triangle, np.roll(triangle, -1, axis=0)):
        if start[1] * end[1] <= 0 and start[1] != end[1]:
            point = start + start[1] / (start[1] - end[1]) * (end - start)
            found.append((float(point[0]), float(point[2])))
    return found
