"""A scene in space whose targets are coloured by what each part of their surface adds to the sensor, by the model."""

from __future__ import annotations

import numpy as np

from analysis.pipeline.model_stage import model_module
from analysis.report.drawing import cut
from analysis.report.plot import SENSOR_COLOUR, Panel
from analysis.report.plots_in_space import Array, colours, figure_in_space, mesh, triangles
from analysis.results.units import CENTIMETRE, VACUUM_PERMITTIVITY
from geometries.scene.readings import targets
from geometries.scene.scene import Scene

_FEMTOFARAD = 1e-15
_PIECES = 24
"""Parts of a scene's longest side that no edge of a coloured piece exceeds: finer than the eye distinguishes in a figure of half a page."""
_DIGITS = 2
_MOST = 6000
"""Triangles above which surfaces are shown as they are, so that a page stays small."""


def coloured(scene: Scene) -> Panel:
    """Returns a scene's bodies in space, targets coloured by capacitance to the first sensor per area (fF/cm²), ε/d in the model.

    Needs the module fringe; ModuleNotFoundError without it.
    """
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
        looks = {
            "colorscale": "YlOrRd",
            "colorbar": {"title": "fF/cm²", "thickness": 12},
            "cmin": 0,
            # Parts in contact have no finite value.
            "cmax": density[np.isfinite(density)].max(initial=0.0),
        }
        traces.append(mesh(name, pieces, intensity=density.round(_DIGITS), intensitymode="cell", **looks))
    share = f" to {sensor.name}" if scene.sensors[1:] else ""
    machine = ", machine (grey)" if len(hit) < len(scene.objects) else ""
    caption = f"sensor (blue){machine}, and what each part of the target adds{share} by the model (fF/cm²)"
    return Panel(caption, figure_in_space(traces, bodies))


def areas(corners: Array) -> Array:
    """Returns the areas (n,) of triangles (n, 3, 3)."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(np.linalg.norm(normals, axis=1) / 2)
