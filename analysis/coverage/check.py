"""`python3 -m analysis measure coverage SCENE …`: compares the distances of surveys with boundary elements, and tries the bound on random bodies."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.coverage import response as responses, survey as surveys
from analysis.coverage.distances import Curves
from analysis.coverage.probes import DEFAULT, Probe, probe
from analysis.coverage.survey import Options, Survey
from analysis.pipeline.model_stage import model_module
from analysis.results.store import write_text
from analysis.show.make import find_scene
from analysis.topics.machines.set_ups import HOUSING, all_set_ups
from geometries.common.arguments import positive_number
from geometries.common.children import temporary_folder
from geometries.scene import reader, shapes
from geometries.scene.scene import Scene

Array = NDArray[np.float64]

_RTOL = 3e-3
"""Relative accuracy of boundary elements."""
_ALLOWED, _SHARE = 1e-3, 0.01
"""Errors of a distance that are meant to be allowed: in metres and of the distance, whichever is larger."""


def distance_errors(
    path: Path, scene: Scene, names: tuple[str, ...], count: int, grid: float | None
) -> Iterator[Checked]:
    """Yields distances at probes, places and readings drawn by chance.

    The error is that of the change there, by boundary elements, over the slope of the survey's changes.
    """
    model = model_module()
    chance = np.random.default_rng(1)
    probes = tuple(probe(name) for name in names)
    survey = surveys.survey(path, scene, probes, Options(grid=grid, methods=()), model)
    candidates = [
        (p, k, at, float(distances[at]), float(farther[at]))
        for p in range(len(probes))
        for k in range(len(survey.readings))
        for distances, farther in [_noticed(survey, p, k)]
        for at in np.flatnonzero(distances > surveys.NEAREST)
    ]
    live = surveys.at_rest(path, scene, model)
    for index in chance.permutation(len(candidates))[:count]:
        p, k, at, distance, farther = candidates[index]
        answer = _by_boundary_elements(live, survey, probes[p], at, distance)[survey.readings[k].name]
        slope = np.log(_STEP) / np.log(farther / distance)
        ratio = abs(answer.change) / survey.thresholds[k]
        error = distance * np.log(ratio) / slope
        uncertain = distance * answer.error["change"] / abs(answer.change) / abs(slope)
        yield Checked(path.stem, probes[p].name, distance, float(error), float(uncertain))


_STEP = 0.95
"""Thresholds for the slope, one over the other."""


def _noticed(survey: Survey, p: int, k: int) -> tuple[Array, Array]:
    """Returns the distances for the threshold and for one a little lower; 0 where either is only the last one looked at."""
    curves = Curves(survey.distances, survey.ratios(p, k))
    distances, is_last = curves.noticed(1.0)
    farther, is_also = curves.noticed(_STEP)
    fit = ~is_last & ~is_also & (farther > distances)
    return np.where(fit, distances, 0.0), farther


def _by_boundary_elements(live: Any, survey: Survey, held: Probe, at: int, distance: float) -> Any:
    posed = live.copy()
    posed.add(surveys.text_of(held, None))
    translations, _ = surveys.held(held, survey.places, distance)
    posed.set_pose(surveys.LINK, translations[at], survey.places.rotations()[at])
    return posed.readings(method="boundary-elements", rtol=_RTOL)


def bound_violations(path: Path, scene: Scene, count: int, grid: float | None) -> tuple[int, float]:
    """Returns how many of so many random grounded bodies that contain a sphere of 2 cm change a proven reading less than the sphere does where it is
    just noticed, and the least ratio of the changes. The bodies are boxes, balls and ellipsoids around the sphere that do not reach behind its place.
    """
    model = model_module()
    ball = probe("sphere:0.02")
    survey = surveys.survey(path, scene, (ball,), Options(grid=grid, methods=()), model)
    machine = surveys.machine_of(surveys.at_rest(path, scene, model), scene, model, Options())
    chance = np.random.default_rng(2)
    proven = [k for k, reading in enumerate(survey.readings) if reading.is_proven]
    places = [
        (k, at, float(distances[at]))
        for k in proven
        for distances in [_noticed(survey, 0, k)[0]]
        for at in np.flatnonzero(distances > 2 * surveys.NEAREST)
    ]
    if not places:
        return 0, np.inf
    chosen = [places[k] for k in chance.integers(len(places), size=count)]
    rotations = survey.places.rotations()
    machine.prepare(
        np.array(
            [survey.places.points[at] + distance * survey.places.normals[at] for _, at, distance in chosen]
        )
    )
    alone = responses.respond(ball, model)
    violations, least = 0, np.inf
    for k, at, distance in chosen:
        body, low = _around(chance, 0.02, distance)
        around = responses.respond_on(_divided(body.triangles), body, model, (_NEAR,))
        translation = survey.places.points[at] + (distance + 0.02) * survey.places.normals[at]
        pose = rotations[at : at + 1], translation[None]
        level = around.level(distance - low)
        small, _ = responses.changes(machine, alone.level(distance), *pose, None)
        large, clears = responses.changes(machine, level, *pose, None)
        if clears[0]:
            ratio = float(large[0, k] / small[0, k])
            least = min(least, ratio)
            violations += ratio < 1
    return violations, least


_NEAR, _FEWEST_PANELS = 0.25, 150
"""Clearance over half the size of the random bodies; and the number of their panels, at least. Galerkin's method on few panels underestimates a
body's change, so that it cannot hide a violation."""


def _divided(triangles: Array) -> Array:
    """Quarters triangles until there are enough panels."""
    while len(triangles) < _FEWEST_PANELS:
        a, b, c = triangles.transpose(1, 0, 2)
        middles = (b + c) / 2, (c + a) / 2, (a + b) / 2
        corners = (
            (a, middles[2], middles[1]),
            (b, middles[0], middles[2]),
            (c, middles[1], middles[0]),
            middles,
        )
        triangles = np.concatenate([np.stack(part, axis=1) for part in corners])
    return triangles


_SEGMENTS = 8
"""Segments of a circle of the rounded bodies."""


def _around(chance: np.random.Generator, radius: float, room: float) -> tuple[Probe, float]:
    """Draws a body around a ball about the origin, and how far it comes out below the ball: at most half the room."""
    lower = float(chance.uniform(0, 0.5) * room)
    reach = radius + np.array([*chance.uniform(0.001, 0.06, size=2), lower + 1e-4])
    shape: shapes.Shape = (
        shapes.Cuboid((2 * reach[0], 2 * reach[1], 2 * reach[2]))
        if chance.random() < 0.5
        else shapes.RoundedCuboid((2 * reach[0], 2 * reach[1], 2 * reach[2]), radius, _SEGMENTS)
    )
    text = f'type = "cuboid", size = {[float(2 * x) for x in reach]}'
    if isinstance(shape, shapes.RoundedCuboid):
        text += f", rounding = {radius}, segments = {_SEGMENTS}"
    return Probe("body", shape.triangles(), text), lower + 1e-4


@dataclass(frozen=True)
class Checked:
    """A distance that the survey of a scene found (m), its error by boundary elements, and what these may be off (m)."""

    scene: str
    probe: str
    distance: float
    error: float
    uncertain: float

    @property
    def beyond(self) -> float:
        """By how much (m) the error is larger than what is allowed; 0 if it is not."""
        return max(0.0, abs(self.error) - max(_ALLOWED, _SHARE * self.distance) - self.uncertain)


def housings(count: int, folder: Path) -> list[Path]:
    """Writes the scenes of the first set-ups of a sensor before a housing, whose target the survey leaves out."""
    chosen = [each for each in all_set_ups() if each.family == HOUSING][:count]
    for each in chosen:
        write_text(folder / f"{each.name}.toml", each.text)
    return [folder / f"{each.name}.toml" for each in chosen]


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds what may be asked for."""
    parser.add_argument("scenes", metavar="SCENE", nargs="+")
    parser.add_argument("--probe", action="append", default=[], metavar="PROBE")
    parser.add_argument("--places", type=int, default=20, metavar="N", help="of each scene")
    parser.add_argument("--housings", type=int, default=0, metavar="N", help="scenes of sensors on housings")
    parser.add_argument("--bodies", type=int, default=100, metavar="N", help="around a sphere, of each SCENE")
    parser.add_argument("--grid", type=positive_number, metavar="M")


def measure(options: argparse.Namespace) -> int:
    """Prints the comparisons that are asked for; returns the exit code: 1 where a distance or the bound fails."""
    probes = tuple(options.probe) or DEFAULT
    given = [find_scene(name) for name in options.scenes]
    found = []
    with temporary_folder() as folder:
        for path in [*given, *housings(options.housings, folder)]:
            for each in distance_errors(path, reader.load(path), probes, options.places, options.grid):
                print(
                    f"{each.scene:16} {each.probe:12} {1000 * each.distance:8.2f} mm  {1000 * each.error:+7.3f} mm ± {1000 * each.uncertain:.3f} mm"
                    + (f", {1000 * each.beyond:.2f} mm too much" if each.beyond else ""),
                    flush=True,
                )
                found.append(each)
    beyond = [each for each in found if each.beyond]
    print(f"{len(beyond)} of {len(found)} distances are off by more than 1 mm and 1 %")
    violated = 0
    for path in given if options.bodies else []:
        violations, least = bound_violations(path, reader.load(path), options.bodies, options.grid)
        violated += violations
        print(
            f"{path.stem}: {violations} of {options.bodies} bodies around the sphere change a reading less; the least ratio is {least:.4f}"
        )
    return 1 if beyond or violated else 0
