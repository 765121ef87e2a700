"""What a survey says in words: how far probes are noticed, where they are not, what other methods would have said, and what becomes of two
claims about capacitive sensors on a machine: that they notice whatever conducts nearby, and that an electrode is blind before its centre."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analysis.coverage.distances import Curves, distances
from analysis.coverage.survey import Survey, over_thresholds
from analysis.results.statistics import grouped
from geometries.common.arrays import Array
from geometries.scene.readings import readings
from geometries.scene.scene import Scene

NEARBY = 0.1
"""Distance (m) from a sensor's plate up to which a place counts as nearby."""
MIDDLE, MARGIN = 1 / 3, 2 / 3
"""Positions on a plate, from 0 at its centre to 1 at its edge: the middle ends at one, the margin begins at the other."""


@dataclass(frozen=True)
class Noticed:
    """Of places where a probe can be held: how many there are, how many notice it, and the distances (m) that a twentieth, half and nineteen
    twentieths of these do not exceed; 0 without any."""

    held: int
    noticed: int
    nearest: float
    median: float
    farthest: float

    @property
    def share(self) -> float:
        return self.noticed / self.held if self.held else 0.0

    @property
    def count(self) -> str:
        return f"{self.noticed} of {self.held}"

    @staticmethod
    def of(found: Array) -> Noticed:
        """Sums up the distances at some places."""
        held = found[np.isfinite(found)]
        seen = held[held > 0]
        low, middle, high = np.quantile(seen, [0.05, 0.5, 0.95]) if len(seen) else (0.0, 0.0, 0.0)
        return Noticed(len(held), len(seen), float(low), float(middle), float(high))


def noticed(survey: Survey) -> list[Noticed]:
    """Returns how any reading notices each probe."""
    return [Noticed.of(distances(survey, p)[0]) for p in range(len(survey.probes))]


def blind_bodies(survey: Survey, probe: int) -> list[tuple[str, int, int]]:
    """Returns, for each sensor and object, at how many of its places a probe can be held, and at how many of these no reading notices it."""
    found, _ = distances(survey, probe)
    owners = np.array(survey.places.owners)
    counts = []
    for name in dict.fromkeys(survey.places.owners):
        own = Noticed.of(found[owners == name])
        if own.held:
            counts.append((str(name), own.held, own.held - own.noticed))
    return counts


@dataclass(frozen=True)
class Comparison:
    """A method's distances beside the survey's, at the places where the survey notices a probe: the median of its distance minus the survey's
    (m) and of the ratio of its change to the survey's, at how many of these places both notice it, at how many the method notices it and the
    survey does not, and at how many it can be held."""

    method: str
    probe: str
    places: int
    excess: float
    ratio: float
    false: int
    asked: int


def comparisons(survey: Survey) -> list[Comparison]:
    """Returns what every other method says of each probe, at the places compared."""

    def distances_of(changes: Array) -> Array:
        return Curves(survey.distances, over_thresholds(changes, survey.thresholds)).noticed(1.0)[0]

    found = []
    for method, changes in survey.by_method.items():
        for probe, whole, other in zip(survey.probes, survey.changes, changes):
            own = whole[survey.compared]
            true, told = distances_of(own), distances_of(other)
            both = (true > 0) & np.isfinite(told)
            known = np.isfinite(own) & np.isfinite(other) & (np.abs(own) > 0)
            near = (over_thresholds(own, survey.thresholds) > 0.5)[..., None] & known
            with np.errstate(over="ignore"):
                ratio = np.median(np.abs(other[near] / own[near])) if near.any() else np.nan
            excess = np.median(told[both] - true[both]) if both.any() else np.nan
            false, asked = int(((true == 0) & (told > 0)).sum()), int(np.isfinite(true).sum())
            medians = float(excess), float(ratio)
            found.append(Comparison(method, probe.name, int(both.sum()), *medians, false, asked))
    return found


def around(scene: Scene, survey: Survey, probe: int) -> tuple[Noticed, Noticed, Noticed]:
    """Returns how any reading notices a probe at places on sensors, at others nearby, and at those farther away."""
    found, _ = distances(survey, probe)
    names = {sensor.name for sensor in scene.sensors}
    on_sensor = np.array([name in names for name in survey.places.owners])
    plates = [plate for name in names for plate in scene.sensor_rectangles(name)]
    nearby = np.min([_offset(survey.places.points, *plate) for plate in plates], axis=0) <= NEARBY
    before, beside, farther = on_sensor, nearby & ~on_sensor, ~nearby & ~on_sensor
    return Noticed.of(found[before]), Noticed.of(found[beside]), Noticed.of(found[farther])


def on_plates(scene: Scene, survey: Survey, probe: int) -> tuple[Noticed, Noticed]:
    """Returns how sensors notice a probe before the middle of their own plates and before the margin, by readings that sense and drive them."""
    names = [reading.name for reading in survey.readings]
    middle, margin = [], []
    for asked in readings(scene):
        if asked.name not in names or asked.sense not in asked.drive:
            continue
        own = np.array([owner == asked.sense for owner in survey.places.owners])
        if not own.any() or asked.sense not in {sensor.name for sensor in scene.sensors}:
            continue
        found, _ = distances(survey, probe, names.index(asked.name))
        for plate in scene.sensor_rectangles(asked.sense):
            on_plate = own & (_offset(survey.places.points, *plate) < 1e-9 + 1e-6 * np.linalg.norm(plate[1]))
            position = np.abs(_position(survey.places.points, *plate)).max(axis=1)
            middle.append(found[on_plate & (position <= MIDDLE)])
            margin.append(found[on_plate & (position >= MARGIN)])
    none = [np.zeros(0)]
    return Noticed.of(np.concatenate(middle or none)), Noticed.of(np.concatenate(margin or none))


def nearby_sentence(scene: Scene, survey: Survey) -> str:
    """Tells for each probe where the machine notices it, and whether the claim that nothing nearby is missed holds."""
    phrases, held = [], []
    for p, probe in enumerate(survey.probes):
        before, beside, farther = around(scene, survey, p)
        phrases.append(f"{probe.name} at {before.count}, {beside.count} and {farther.count}")
        held.append(before.share == 1 and beside.share == 1)
    by_verdict = grouped(zip(held, survey.probes), lambda each: each[0])
    names = {holds: ", ".join(probe.name for _, probe in each) for holds, each in by_verdict.items()}
    told = {True: "it holds for", False: "it does not hold for"}
    verdict = "; ".join(f"{words} {names[holds]}" for holds, words in told.items() if holds in names)
    return (
        "A sensor with a sensing volume misses what is outside of it, a capacitive sensor would notice any conducting body nearby: so the thesis that the model comes from. Here the probes "
        f"are noticed on the sensors, at other places at most {100 * NEARBY:g} cm from a sensor, and farther away: {'; '.join(phrases)}. For what is nearby {verdict}."
    )


def centre_sentence(scene: Scene, survey: Survey) -> str:
    """Tells for each probe how it is noticed before the middle and the margin of the plates, and whether there is a blind spot in the middle."""
    phrases, blind, weaker = [], [], []
    for p, probe in enumerate(survey.probes):
        middle, margin = on_plates(scene, survey, p)
        if not middle.held or not margin.held:
            continue
        told = [
            f"{each.count} places" + (f" (from {100 * each.median:.3g} cm)" if each.noticed else "")
            for each in (middle, margin)
        ]
        phrases.append(f"{probe.name} at {' and at '.join(told)}")
        blind += [probe.name] if middle.share < margin.share else []
        weaker += [probe.name] if middle.median < margin.median else []
    if not phrases:
        return ""
    verdict = (
        f"The middle misses more of the places than the margin for {', '.join(blind)}: the blind spot is there."
        if blind
        else "The middle misses no larger share of its places than the margin does: there is no blind spot at the centre."
    )
    if weaker:
        verdict += f" It notices {', '.join(weaker)} from a shorter distance than the margin."
    return (
        "A manual of such a machine warns of a blind spot at an electrode's centre. Before the middle ninth of the plates, and before their margin, the outer third on all sides, "
        f"a sensor notices by its own reading: {'; '.join(phrases)}. {verdict}"
    )


def _position(points: Array, corner: Array, u: Array, v: Array) -> Array:
    """Returns the points' coordinates (n, 2) along a rectangle's edges, from −1 to 1 over it."""
    offset = points - corner
    return np.stack([2 * (offset @ edge) / (edge @ edge) - 1 for edge in (u, v)], axis=1)


def _offset(points: Array, corner: Array, u: Array, v: Array) -> Array:
    """Returns the points' distances (n,) from a rectangle."""
    share = np.clip((_position(points, corner, u, v) + 1) / 2, 0, 1)
    return np.asarray(np.linalg.norm(points - corner - share @ np.stack([u, v]), axis=1))
