"""The survey of a machine: changes of all readings for each probe, at each place, from a few distances."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from analysis.coverage.machine import Level, Machine, Reading, Response, respond
from analysis.coverage.places import Places, Probe, spread
from analysis.results.store import Document
from analysis.show import load
from geometries.common.arrays import Array, Flags, Indices
from geometries.common.errors import InputError
from geometries.scene.scene import Link, Object, Scene
from geometries.scene.shapes import SHEETS
from geometries.scene.writer import canonical
from geometries.studies.families import FLOATING, GROUNDED

BOUNDARY_ELEMENTS, SMALL = "boundary-elements", "small-probe"
"""The survey's own method; and its limit for small probes, the probe's capacitance times the potentials φ·φ' at its middle."""
NEAREST, FARTHEST, COUNT = 0.005, 1.0, 9
"""The distances (m) between a place and the nearest point of a probe."""
NEGLIGIBLE = 0.03
"""Changes below this part of the threshold are those of the limit for small probes."""
_COMPARED = 12
"""At how many places methods are compared."""
_SAMPLE = 3000
"""Largest number of points for which the machine's answers are chosen."""
RESOLUTION = 0.5e-15
"""Resolution (F) of a common converter, the FDC1004 (Texas Instruments, SNOSCY5), whose five-fold is the threshold where a scene says nothing."""


@dataclass(frozen=True)
class Options:
    """What is asked: the readings by name, none for all; the side of a place's square in m, None for about 2,000 places; whether the probe is
    grounded (None) or connected to ground through a capacitance (F), 0 if insulated; methods to compare with at a few places.
    """

    readings: tuple[str, ...] = ()
    grid: float | None = None
    to_ground: float | None = None
    threshold: float | None = None
    methods: tuple[str, ...] = ("exact", "formula", SMALL)


@dataclass(frozen=True)
class Survey:
    """Changes by probe: (places, distances, readings) in F, NaN from where on the probe would touch the machine; by the name of a method the same
    at the places numbered in `compared`."""

    readings: tuple[Reading, ...]
    thresholds: tuple[float, ...]
    places: Places
    distances: Array
    probes: tuple[Probe, ...]
    changes: tuple[Array, ...]
    compared: Indices
    by_method: dict[str, tuple[Array, ...]]
    panels: int
    error: float


def over_thresholds(changes: Array, thresholds: tuple[float, ...], reading: int | None = None) -> Array:
    """Returns the absolute values of changes (…, readings) over the thresholds, of one reading or the largest of all."""
    # The triangle integral of a touching probe is as good as infinite.
    with np.errstate(over="ignore"):
        ratios = np.abs(changes) / np.array(thresholds)
    return np.asarray(ratios.max(axis=-1) if reading is None else ratios[..., reading])


@dataclass(frozen=True)
class Approach:
    """A probe on its way out along the normals of places: the turns (places, 3, 3) that map its frame to the world, where its origin is
    (distances, places, 3), the level of its response at each distance, and where (places, distances) it touches nothing so far.
    """

    rotations: Array
    translations: Array
    levels: tuple[Level, ...]
    fits: Flags

    def at(self, places: Indices) -> Approach:
        """Returns the same for some of the places."""
        return Approach(self.rotations[places], self.translations[:, places], self.levels, self.fits[places])

    def changes(self, ask: Callable[[Level, Array, Array], Array]) -> Array:
        """Returns the changes (places, distances, readings) that are told of levels, turns and places; NaN where the probe does not fit."""
        found = []
        for level, translations, here in zip(self.levels, self.translations, self.fits.T):
            values = ask(level, self.rotations[here], translations[here])
            whole = np.full((len(here), values.shape[1]), np.nan)
            whole[here] = values
            found.append(whole)
        return np.stack(found, axis=1)


def survey(path: Path, scene: Scene, probes: tuple[Probe, ...], options: Options, model: Any) -> Survey:
    """Surveys a scene. Its marked targets are left out; without any, all objects stay: they are the machine."""
    live = at_rest(path, scene, model)
    machine = Machine(live, scene.medium.relative_permittivity)
    chosen = _chosen(machine.readings, options.readings)
    conductors = live.conductors()
    flat = [body.name for body in scene.objects if isinstance(body.shape, SHEETS)]
    sheets = frozenset([sensor.name for sensor in scene.sensors] + flat)
    places = spread(conductors, sheets, options.grid)
    distances = np.geomspace(NEAREST, FARTHEST, COUNT)
    ways = [approach(respond(probe, model), places, distances, live) for probe in probes]
    asked, usual = options.threshold, 5 * RESOLUTION
    thresholds = tuple(asked or reading.threshold or usual for reading in machine.readings)
    small = partial(machine.small_changes, to_ground=options.to_ground)
    estimates = [way.changes(small) for way in ways]
    farthest = places.points[:1] + FARTHEST * places.normals[:1]
    machine.prepare(_where_it_counts(ways, estimates, thresholds, farthest))
    accurate = partial(_accurate, machine, thresholds, options.to_ground)
    changes = tuple(accurate(way, estimate)[..., chosen] for way, estimate in zip(ways, estimates))
    count = _COMPARED if options.methods else 0
    compared = np.unique(np.linspace(0, len(places.points) - 1, count).astype(np.int64))

    def by(method: str, probe: Probe) -> Callable[[Level, Array, Array], Array]:
        if method == SMALL:
            return small
        posed = live.copy()
        posed.add(described(probe, options.to_ground))
        return partial(_asked, posed, method, machine)

    by_method = {
        method: tuple(
            way.at(compared).changes(by(method, probe))[..., chosen] for probe, way in zip(probes, ways)
        )
        for method in options.methods
    }
    read, noticed = tuple(machine.readings[k] for k in chosen), tuple(thresholds[k] for k in chosen)
    told = changes, compared, by_method, machine.panels, machine.error
    return Survey(read, noticed, places, distances, probes, *told)


def at_rest(path: Path, scene: Scene, model: Any) -> Any:
    """Loads the scene in the model without its targets."""
    live = load(path, model)
    for body in scene.objects:
        if body.target:
            live.hide(body.name)
    return live


def _chosen(readings: tuple[Reading, ...], names: tuple[str, ...]) -> list[int]:
    known = [reading.name for reading in readings]
    for name in names:
        if name not in known:
            raise InputError("--reading", "", f"{name!r} is none of {', '.join(known)}")
    return [known.index(name) for name in names] if names else list(range(len(known)))


def approach(response: Response, places: Places, distances: Array, live: Any) -> Approach:
    """Returns the way of a probe whose lowest point is at each distance from each place, from the nearest one outwards."""
    posed = live.copy()
    posed.add(described(response.probe, None))
    heights = response.probe.triangles[..., 2]
    low, high = float(heights.min()), float(heights.max())
    rotations = places.rotations()
    translations = places.points + (distances[:, None, None] - low) * places.normals
    fits, found = np.ones(len(rotations), dtype=bool), []
    for distance, there in zip(distances, translations):
        fits &= distance + (high - low) < places.free
        for k in np.flatnonzero(fits):
            posed.set_pose(LINK, there[k], rotations[k])
            met = (pair for pair in posed.collide()["pairs"] if pair["status"] == "collision")
            fits[k] = not any(_PROBE in (pair["a"], pair["b"]) for pair in met)
        found.append(fits.copy())
    levels = tuple(response.level(float(distance)) for distance in distances)
    return Approach(rotations, translations, levels, np.stack(found, axis=1))


def _where_it_counts(
    ways: list[Approach], estimates: list[Array], thresholds: tuple[float, ...], farthest: Array
) -> Array:
    """Returns points of the probes (n, 3) where they may be noticed, or nearly so: for these the machine's answer has to be known."""
    found = [farthest]
    for way, estimate in zip(ways, estimates):
        counts = np.nan_to_num(over_thresholds(estimate, thresholds), nan=0.0) > NEGLIGIBLE
        for level, translations, here in zip(way.levels, way.translations, counts.T):
            placed = np.einsum("nij,pj->npi", way.rotations[here], level.points)
            found.append((placed + translations[here, None]).reshape(-1, 3))
    points = np.concatenate(found)
    count = min(len(points), _SAMPLE)
    return np.asarray(np.random.default_rng(1).choice(points, count, replace=False))


def _accurate(
    machine: Machine, thresholds: tuple[float, ...], to_ground: float | None, way: Approach, estimate: Array
) -> Array:
    """Returns the changes (places, distances, readings) with the machine's answer to the probe; the estimates of the limit for small probes
    where these are negligible."""
    found, exact = estimate.copy(), np.zeros(estimate.shape[:2], dtype=bool)
    fits = np.ones(len(estimate), dtype=bool)
    for step, (level, translations) in enumerate(zip(way.levels, way.translations)):
        fits &= np.isfinite(estimate[:, step]).all(axis=1)
        known = np.nan_to_num(over_thresholds(estimate[:, step], thresholds), nan=0.0)
        counts = np.flatnonzero(fits & (known > NEGLIGIBLE))
        posed = way.rotations[counts], translations[counts]
        found[counts, step], clears = machine.changes(level, *posed, to_ground)
        fits[counts] = clears
        found[~fits, step] = np.nan
        exact[counts, step] = clears
    return _continued(found, estimate, exact)


def _continued(found: Array, estimate: Array, exact: Flags) -> Array:
    """Scales the estimates (places, distances, readings) beyond the last exact change by the ratio there, so that they go on from it."""
    count = exact.shape[1]
    last = count - 1 - exact[:, ::-1].argmax(axis=1)
    rows = np.arange(len(found))
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = found[rows, last] / estimate[rows, last]
    ratio = np.where(np.isfinite(ratio) & exact.any(axis=1)[:, None], ratio, 1.0)
    beyond = np.arange(count) > last[:, None]
    return np.where(beyond[..., None], found * ratio[:, None], found)


LINK, _PROBE = "probe of the coverage", "the probe"


def described(probe: Probe, to_ground: float | None) -> Document:
    """Returns what a scene has of a probe on a link of its own: grounded, or else connected to ground through a capacitance (F)."""
    potential = GROUNDED if to_ground is None else FLOATING
    body = Object(_PROBE, probe.shape, LINK, potential=potential, to_ground=to_ground or 0.0, target=True)
    whole = tomllib.loads(canonical(Scene(links=(Link(LINK),), objects=(body,))))
    return {part: whole[part] for part in ("link", "object")}


def _asked(
    posed: Any, method: str, machine: Machine, _: Level, rotations: Array, translations: Array
) -> Array:
    """Asks the model pose by pose; 0 where it does not know the change."""
    found = np.zeros((len(translations), len(machine.readings)))
    for k, (rotation, translation) in enumerate(zip(rotations, translations)):
        posed.set_pose(LINK, translation, rotation)
        try:
            answers = posed.readings(method=method)
        except ValueError as error:
            raise InputError("--method", "", str(error)) from error
        found[k] = [answers[reading.name].change or 0.0 for reading in machine.readings]
    return np.nan_to_num(found, nan=0.0)
