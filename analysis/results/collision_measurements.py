"""Measurements of collision detection: right and wrong answers, run times of queries and of scenes."""

from __future__ import annotations

from dataclasses import dataclass

from analysis.results.measurements import Origin, origin
from analysis.results.store import Document


@dataclass(frozen=True)
class PairClass:
    """The answers on pairs of one kind, compared with exact arithmetic.

    `wrong` and `unproven` are of this project's answers; `exact` counts the pairs that needed exact arithmetic;
    `thesis_wrong` and `thesis_endless` are of the thesis' algorithm as it is printed.
    """

    name: str
    pairs: int
    intersecting: int
    wrong: int
    unproven: int
    exact: int
    thesis_wrong: int
    thesis_endless: int


@dataclass(frozen=True)
class QueryTimes:
    """Nanoseconds per query and how many pairs were found to intersect, by library."""

    name: str
    pairs: int
    nanoseconds: dict[str, float]
    intersecting: dict[str, int]


@dataclass(frozen=True)
class SceneTimes:
    """Milliseconds per frame and collisions found, by the way of finding them."""

    objects: int
    milliseconds: dict[str, float]
    collisions: dict[str, int]


@dataclass(frozen=True)
class Collision:
    """The measurements; empty where one is missing. `origins` has one entry for each measurement, in this order."""

    origins: tuple[Origin, ...]
    classes: tuple[PairClass, ...]
    queries: tuple[QueryTimes, ...]
    scenes: tuple[SceneTimes, ...]


def collision(
    answers: Document | None, queries: Document | None, scenes: Document | None
) -> Collision | None:
    """Returns the stored answers of the three programs; None without any."""
    documents = [document for document in (answers, queries, scenes) if document is not None]
    if not documents:
        return None
    return Collision(
        tuple(map(origin, documents)),
        tuple(PairClass(**entry) for entry in _entries(answers, "classes")),
        tuple(_query_times(entry) for entry in _entries(queries, "rows")),
        tuple(_scene_times(entry) for entry in _entries(scenes, "scenes")),
    )


def _entries(document: Document | None, key: str) -> list[Document]:
    return [] if document is None else list(document["answer"][key])


def _query_times(entry: Document) -> QueryTimes:
    peers = entry["peers"]
    return QueryTimes(
        entry["name"],
        entry["pairs"],
        {peer["name"]: float(peer["nanoseconds"]) for peer in peers},
        {peer["name"]: int(peer["intersecting"]) for peer in peers},
    )


def _scene_times(entry: Document) -> SceneTimes:
    ways = entry["ways"]
    return SceneTimes(
        entry["objects"],
        {way["name"]: float(way["milliseconds"]) for way in ways},
        {way["name"]: int(way["collisions"]) for way in ways},
    )
