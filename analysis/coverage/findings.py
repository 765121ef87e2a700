"""What a survey says in words: how far probes are noticed, where they are not, and what other methods would have said."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analysis.coverage import tables
from analysis.coverage.distances import Curves
from analysis.coverage.survey import Survey, over_thresholds


@dataclass(frozen=True)
class Summary:
    """How a probe is noticed by any reading: places where it can be held, those where it is noticed, and quantiles of the distances there (m)."""

    probe: str
    held: int
    noticed: int
    nearest: float
    median: float
    farthest: float


def summaries(survey: Survey) -> list[Summary]:
    """Returns a summary for each probe."""
    found = []
    for p, probe in enumerate(survey.probes):
        distances, _ = tables.distances(survey, p, None)
        held = distances[np.isfinite(distances)]
        seen = held[held > 0]
        low, middle, high = np.quantile(seen, [0.05, 0.5, 0.95]) if len(seen) else (0.0, 0.0, 0.0)
        found.append(Summary(probe.name, len(held), len(seen), float(low), float(middle), float(high)))
    return found


def blind_bodies(survey: Survey, probe: int) -> list[tuple[str, int, int]]:
    """Returns, for each sensor and object, at how many of its places a probe can be held, and at how many of these no reading notices it."""
    distances, _ = tables.distances(survey, probe, None)
    owners = np.array(survey.places.owners)
    counts = []
    for name in dict.fromkeys(survey.places.owners):
        own = distances[(owners == name) & np.isfinite(distances)]
        if len(own):
            counts.append((str(name), len(own), int((own == 0).sum())))
    return counts


@dataclass(frozen=True)
class Comparison:
    """A method's distances beside the survey's, at the places where the survey notices a probe: how many places, the median of its distance minus
    the survey's (m) and of the ratio of its change to the survey's, and at how many places it notices a probe that the survey does not.
    """

    method: str
    probe: str
    places: int
    excess: float
    ratio: float
    false: int
    asked: int


def comparisons(survey: Survey) -> list[Comparison]:
    """Returns what every other method says of each probe, at the places compared."""
    found = []
    for method, changes in survey.by_method.items():
        for p, probe in enumerate(survey.probes):
            own = survey.changes[p][survey.compared]
            true, _ = Curves(survey.distances, over_thresholds(own, survey.thresholds, None)).noticed(1.0)
            told, _ = Curves(survey.distances, over_thresholds(changes[p], survey.thresholds, None)).noticed(
                1.0
            )
            both = (true > 0) & np.isfinite(told)
            known = np.isfinite(own) & np.isfinite(changes[p]) & (np.abs(own) > 0)
            near = (over_thresholds(own, survey.thresholds, None) > 0.5)[..., None] & known
            with np.errstate(over="ignore"):
                ratio = np.median(np.abs(changes[p][near] / own[near])) if near.any() else np.nan
            excess = np.median(told[both] - true[both]) if both.any() else np.nan
            false = int(((true == 0) & (told > 0)).sum())
            found.append(
                Comparison(
                    method,
                    probe.name,
                    int(both.sum()),
                    float(excess),
                    float(ratio),
                    false,
                    int(np.isfinite(true).sum()),
                )
            )
    return found
