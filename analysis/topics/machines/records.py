"""Set-ups on machines with the true change of their reading, the model's, and the parts of the model's error."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from analysis.results.answers import Estimate
from analysis.results.store import Document
from analysis.topics.errors import records as records_of_pairs
from analysis.topics.machines import parts
from analysis.topics.machines.parts import ALL_PARTS, OnMachine, Pairs
from analysis.topics.machines.set_ups import SetUp
from analysis.topics.spread import Spread, spread


@dataclass(frozen=True, eq=False)
class Entry:
    """A set-up; `methods` holds the change (F) by each method that answers. `pairs` is None for a reading between two sensors."""

    set_up: SetUp
    true: OnMachine
    pairs: Pairs | None
    methods: dict[str, float]

    @property
    def change(self) -> Estimate:
        """The true change (F)."""
        return self.true.full

    def ratio(self, method: str) -> float:
        """Returns a method's change over the true one; not a number if the method has no answer."""
        return self.methods.get(method, math.nan) / self.change.value

    @property
    def error(self) -> float:
        """(model − truth)/truth, by the model with all triangles; −1 for a reading between sensors, of which the model gives nothing."""
        return (self.pairs.every if self.pairs else 0.0) / self.change.value - 1

    def parts(self) -> dict[str, float]:
        """Returns the parts of the relative error, which add up to it; 0 for what the set-up does not have."""
        company = {name: part.value for name, part in self.true.company().items()}
        pair = self.pairs.parts() if self.pairs else {parts.NOT_KNOWN: -self.true.alone.value}
        found = company | pair
        return {name: found.get(name, 0.0) / self.change.value for name in ALL_PARTS}

    @property
    def largest(self) -> str:
        """The name of the largest part."""
        found = self.parts()
        return max(found, key=lambda name: abs(found[name]))


@dataclass(frozen=True)
class OfPart:
    """A part over the set-ups that have it, relative to the truth. `largest_in` counts where it is the greatest part."""

    name: str
    count: int
    median: float
    least: float
    greatest: float
    largest_in: int


def statistics(found: list[Entry], method: str) -> Spread | None:
    """Returns how a method's changes over the true ones are spread, about 1; None if it answers none of the set-ups."""
    return spread((entry.ratio(method) for entry in found), true=1.0)


def of_parts(found: list[Entry]) -> list[OfPart]:
    """Returns every part that some set-up has."""
    made = []
    for name in ALL_PARTS:
        values = [value for entry in found if (value := entry.parts()[name]) != 0]
        if values:
            largest = sum(entry.largest == name for entry in found)
            made.append(
                OfPart(name, len(values), float(np.median(values)), min(values), max(values), largest)
            )
    return made


def entry(set_up: SetUp, document: Document) -> Entry:
    """Returns a set-up with its answer."""
    changes = {
        tuple(each["included"]): Estimate(each["value"], each["error"]) for each in document["changes"]
    }
    stored = document["pairs"]
    pairs = None if stored is None else _pairs(stored)
    methods = {name: each["change"] for name, each in document["methods"].items() if "change" in each}
    return Entry(set_up, OnMachine(changes), pairs, methods)


def _pairs(stored: Document) -> Pairs:
    return Pairs(
        truths=tuple(records_of_pairs.truth(each) for each in stored["truths"]),
        every=stored["every"],
        facing=stored["facing"],
        split=records_of_pairs.split(stored["split"]) if stored["split"] else None,
    )
