"""The survey of a machine: changes of all readings for each probe, at each place, from a few distances."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.coverage import response as responses
from analysis.coverage.machine import Machine, Reading
from analysis.coverage.places import Places, spread
from analysis.coverage.probes import Probe
from geometries.common.errors import InputError
from geometries.scene.scene import Scene
from geometries.scene.shapes import SHEETS

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

BOUNDARY_ELEMENTS, SMALL = "boundary-elements", "small-probe"
"""The survey's own method; and its limit for small probes, the probe's capacitance times the potentials φ·φ' at its middle."""
NEAREST, FARTHEST, COUNT = 0.005, 1.0, 9
"""The distances (m) between a place and the nearest point of a probe."""
NEGLIGIBLE = 0.03
"""Changes below this part of the threshold are those of the limit for small probes."""
_SAMPLE = 3000
"""Largest number of points for which the machine's answers are chosen."""
RESOLUTION = 0.5e-15
"""Resolution (F) of a common converter, the FDC1004 (Texas Instruments, SNOSCY5), whose five-fold is the threshold where a scene says nothing."""


@dataclass(frozen=True)
class Options:
    """What is asked: the readings by name, none for all; the side of a place's square in m, None for about 2,000 places; whether the probe is
    grounded (None) or connected to ground through a capacitance (F), 0 if insulated; methods to compare with, at how many places.
    """

    readings: tuple[str, ...] = ()
    grid: float | None = None
    to_ground: float | None = None
    threshold: float | None = None
    methods: tuple[str, ...] = ("exact", "formula", SMALL)
    compared: int = 12
    rtol: float = 0.004
    most_panels: int = 12000
    parts: int = 600


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
    compared: NDArray[np.int64]
    by_method: dict[str, tuple[Array, ...]]
    panels: int
    error: float

    def ratios(self, probe: int, reading: int | None) -> Array:
        """Returns changes over thresholds (places, distances), of one reading or the largest of all."""
        return over_thresholds(self.changes[probe], self.thresholds, reading)


def over_thresholds(changes: Array, thresholds: tuple[float, ...], reading: int | None) -> Array:
    """Returns the absolute values of changes (…, readings) over the thresholds, of one reading or the largest of all."""
    # The triangle integral of a touching probe is as good as infinite.
    with np.errstate(over="ignore"):
        ratios = np.abs(changes) / np.array(thresholds)
    return np.asarray(ratios.max(axis=-1) if reading is None else ratios[..., reading])


def survey(path: Path, scene: Scene, probes: tuple[Probe, ...], options: Options, model: Any) -> Survey:
    """Surveys a scene. Its marked targets are left out; without any, all objects stay: they are the machine."""
    live = at_rest(path, scene, model)
    machine = machine_of(live, scene, model, options)
    chosen = _chosen(machine.readings, options.readings)
    conductors = live.conductors()
    sheets = frozenset(sensor.name for sensor in scene.sensors) | frozenset(
        body.name for body in scene.objects if isinstance(body.shape, SHEETS)
    )
    grid = options.grid or _grid_for(conductors, 2000)
    places = spread(conductors, sheets, grid)
    distances = np.geomspace(NEAREST, FARTHEST, COUNT)
    answers = [responses.respond(probe, model) for probe in probes]
    are_clear = [clear(probe, places, distances, live) for probe in probes]
    thresholds = tuple(
        options.threshold or reading.threshold or 5 * RESOLUTION for reading in machine.readings
    )
    estimates = [
        _changes_of(
            probe,
            places,
            distances,
            fits,
            lambda level, turns, shifts: _small(machine, level, turns, shifts, options.to_ground),
            answer.level,
        )
        for probe, answer, fits in zip(probes, answers, are_clear)
    ]
    machine.prepare(_where_it_counts(places, distances, answers, estimates, thresholds))
    changes = tuple(
        _accurate(machine, thresholds, options.to_ground, answer, places, distances, estimate)[..., chosen]
        for answer, estimate in zip(answers, estimates)
    )
    compared = (
        np.unique(np.linspace(0, len(places.points) - 1, options.compared).astype(np.int64))
        if options.methods
        else np.zeros(0, np.int64)
    )
    by_method = {
        method: _by_method(
            method, live, machine, options, places, compared, distances, probes, answers, are_clear, chosen
        )
        for method in options.methods
    }
    readings = tuple(machine.readings[k] for k in chosen)
    return Survey(
        readings,
        tuple(thresholds[k] for k in chosen),
        places,
        distances,
        probes,
        changes,
        compared,
        by_method,
        machine.panels,
        machine.error,
    )


def machine_of(live: Any, scene: Scene, model: Any, options: Options) -> Machine:
    """Solves the machine of a scene that `at_rest` returned."""
    return Machine(live, scene.medium.relative_permittivity, options.rtol, options.most_panels, options.parts)


def at_rest(path: Path, scene: Scene, model: Any) -> Any:
    """Loads the scene in the model without its targets."""
    try:
        live = model.Scene.load(str(path))
        for body in scene.objects:
            if body.target:
                live.hide(body.name)
    except ValueError as error:
        raise InputError("", "", str(error)) from error
    return live


def _chosen(readings: tuple[Reading, ...], names: tuple[str, ...]) -> list[int]:
    known = [reading.name for reading in readings]
    for name in names:
        if name not in known:
            raise InputError("--reading", "", f"{name!r} is none of {', '.join(known)}")
    return [known.index(name) for name in names] if names else list(range(len(known)))


def _grid_for(conductors: dict[str, Array], count: int) -> float:
    triangles = np.concatenate(list(conductors.values()))
    cross = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return float(np.sqrt(np.linalg.norm(cross, axis=1).sum() / 2 / count))


def _where_it_counts(
    places: Places,
    distances: Array,
    answers: list[responses.Response],
    estimates: list[Array],
    thresholds: tuple[float, ...],
) -> Array:
    """Returns points of the probes (n, 3) where they may be noticed, or nearly so: for these the machine's answer has to be known."""
    rotations, found = places.rotations(), [places.points[:1] + FARTHEST * places.normals[:1]]
    for answer, estimate in zip(answers, estimates):
        counts = np.nan_to_num(over_thresholds(estimate, thresholds, None), nan=0.0) > NEGLIGIBLE
        for step, distance in enumerate(distances):
            here = counts[:, step]
            translations, _ = held(answer.probe, places, float(distance))
            placed = np.einsum("nij,pj->npi", rotations[here], answer.level(float(distance)).points)
            found.append((placed + translations[here, None]).reshape(-1, 3))
    points = np.concatenate(found)
    return np.asarray(
        points[np.random.default_rng(1).choice(len(points), min(len(points), _SAMPLE), replace=False)]
    )


def _accurate(
    machine: Machine,
    thresholds: tuple[float, ...],
    to_ground: float | None,
    answer: responses.Response,
    places: Places,
    distances: Array,
    estimate: Array,
) -> Array:
    """Returns the changes as `_changes_of` does, with the machine's answer to the probe; the estimates of the limit for small probes where
    these are negligible."""
    found, rotations = estimate.copy(), places.rotations()
    fits, exact = np.ones(len(rotations), dtype=bool), np.zeros(estimate.shape[:2], dtype=bool)
    for step, distance in enumerate(distances):
        translations, _ = held(answer.probe, places, float(distance))
        fits &= np.isfinite(estimate[:, step]).all(axis=1)
        known = np.nan_to_num(over_thresholds(estimate[:, step], thresholds, None), nan=0.0)
        counts = np.flatnonzero(fits & (known > NEGLIGIBLE))
        found[counts, step], clears = responses.changes(
            machine, answer.level(float(distance)), rotations[counts], translations[counts], to_ground
        )
        fits[counts] = clears
        found[~fits, step] = np.nan
        exact[counts, step] = clears
    return _continued(found, estimate, exact)


def _continued(found: Array, estimate: Array, exact: Mask) -> Array:
    """Scales the estimates (places, distances, readings) beyond the last exact change by the ratio there, so that they go on from it."""
    count = exact.shape[1]
    last = count - 1 - exact[:, ::-1].argmax(axis=1)
    rows = np.arange(len(found))
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = found[rows, last] / estimate[rows, last]
    ratio = np.where(np.isfinite(ratio) & exact.any(axis=1)[:, None], ratio, 1.0)
    beyond = np.arange(count) > last[:, None]
    return np.where(beyond[..., None], found * ratio[:, None], found)


def clear(probe: Probe, places: Places, distances: Array, live: Any) -> Mask:
    """Tells (places, distances) where a probe that comes from the nearest distance outwards touches nothing so far."""
    posed = live.copy()
    posed.add(text_of(probe, None))
    rotations = places.rotations()
    fits, found = np.ones(len(rotations), dtype=bool), []
    for distance in distances:
        translations, own = held(probe, places, float(distance))
        fits &= own
        for k in np.flatnonzero(fits):
            posed.set_pose(LINK, translations[k], rotations[k])
            fits[k] = not any(
                pair["status"] == "collision" and _PROBE in (pair["a"], pair["b"])
                for pair in posed.collide()["pairs"]
            )
        found.append(fits.copy())
    return np.stack(found, axis=1)


def _changes_of(
    probe: Probe,
    places: Places,
    distances: Array,
    fits: Mask,
    changes: Callable[[responses.Level, Array, Array], Array],
    level: Callable[[float], responses.Level],
) -> Array:
    """Returns the changes (places, distances, readings); NaN where the probe does not fit."""
    rotations = places.rotations()
    found = []
    for step, distance in enumerate(distances):
        here = fits[:, step]
        translations, _ = held(probe, places, float(distance))
        values = changes(level(float(distance)), rotations[here], translations[here])
        whole = np.full((len(rotations), values.shape[1]), np.nan)
        whole[here] = values
        found.append(whole)
    return np.stack(found, axis=1)


def held(probe: Probe, places: Places, distance: float) -> tuple[Array, Mask]:
    """Returns where a probe's origin is (places, 3) when its lowest point is so far from each place, and whether it fits before what comes next."""
    low, high = float(probe.triangles[..., 2].min()), float(probe.triangles[..., 2].max())
    translations = places.points + (distance - low) * places.normals
    return translations, distance + (high - low) < places.free


def _by_method(
    method: str,
    live: Any,
    machine: Machine,
    options: Options,
    places: Places,
    compared: NDArray[np.int64],
    distances: Array,
    probes: tuple[Probe, ...],
    answers: list[responses.Response],
    are_clear: list[Mask],
    chosen: list[int],
) -> tuple[Array, ...]:
    """Returns the changes by another method at some places, as in Survey."""
    some = Places(
        places.points[compared],
        places.normals[compared],
        tuple(places.owners[k] for k in compared),
        places.free[compared],
    )
    found = []
    for probe, answer, fits in zip(probes, answers, are_clear):
        if method == SMALL:
            values = _changes_of(
                probe,
                some,
                distances,
                fits[compared],
                lambda level, turns, shifts: _small(machine, level, turns, shifts, options.to_ground),
                answer.level,
            )
        else:
            posed = live.copy()
            posed.add(text_of(probe, options.to_ground))
            values = _changes_of(
                probe,
                some,
                distances,
                fits[compared],
                lambda level, turns, shifts: _asked(posed, method, machine, turns, shifts),
                answer.level,
            )
        found.append(values[..., chosen])
    return tuple(found)


def _small(
    machine: Machine, level: responses.Level, rotations: Array, translations: Array, to_ground: float | None
) -> Array:
    """The limit for small grounded probes: own capacitance times the potentials at the middle of the probe's charge."""
    alone = level.charges
    middle = alone @ level.points / alone.sum()
    senses, drives = machine.potentials(np.einsum("nij,j->ni", rotations, middle) + translations)
    capacitance = alone.sum() if to_ground is None else 0.0
    if to_ground is not None:
        share = to_ground / machine.factor
        capacitance = alone.sum() * share / (alone.sum() + share)
    signs = [reading.sign for reading in machine.readings]
    return np.asarray(machine.factor * capacitance * senses * drives * signs)


LINK, _PROBE = "probe of the coverage", "the probe"


def text_of(probe: Probe, to_ground: float | None) -> str:
    potential = 'potential = "grounded"' if to_ground is None else 'potential = "floating"'
    if to_ground:
        potential += f"\nto_ground = {to_ground!r}"
    return (
        f'\n[[link]]\nname = "{LINK}"\n[[object]]\nname = "{_PROBE}"\nlink = "{LINK}"\nshape = {{ {probe.text} }}\n'
        f"target = true\n{potential}\n"
    )


def _asked(posed: Any, method: str, machine: Machine, rotations: Array, translations: Array) -> Array:
    """Asks the model pose by pose; NaN where it does not know the change."""
    found = np.full((len(translations), len(machine.readings)), np.nan)
    for k, (rotation, translation) in enumerate(zip(rotations, translations)):
        posed.set_pose(LINK, translation, rotation)
        try:
            answers = posed.readings(method=method)
        except ValueError as error:
            raise InputError("--method", "", str(error)) from error
        for at, reading in enumerate(machine.readings):
            change = answers[reading.name].change
            found[k, at] = np.nan if change is None else change
    return np.nan_to_num(found, nan=0.0)
