"""Set-ups with their truth and the parts of their error."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from analysis.results.answers import Estimate, ReferenceAnswer
from analysis.results.store import Document
from analysis.results.study_results import Results
from analysis.results.table import MUTUAL
from analysis.topics.errors import parts
from analysis.topics.errors.parts import Part, Split, Truth
from analysis.topics.errors.set_ups import SetUp


@dataclass(frozen=True, eq=False)
class Entry:
    """A set-up with the parts of its error; `reached` tells whether the truth is as accurate as asked."""

    set_up: SetUp
    truth: Truth
    split: Split
    reached: bool

    def true(self, quantity: str) -> Estimate:
        return self.truth.mutual if quantity == MUTUAL else self.truth.delta_self

    def error(self, quantity: str) -> float:
        """Returns (model − truth)/truth."""
        return self.split.model / self.true(quantity).value - 1

    def parts(self, quantity: str) -> dict[str, float]:
        """Returns the parts of the relative error, which add up to it."""
        value = self.true(quantity).value
        return {name: part / value for name, part in parts.parts(self.split, self.truth, quantity).items()}

    def uncertainty(self, quantity: str) -> float:
        """Returns the largest uncertainty of any part, relative to the truth."""
        most = max(parts.uncertainty(self.split, self.truth, name) for name in parts.PARTS[quantity])
        return most / self.true(quantity).value

    def spread(self, name: str, quantity: str) -> float:
        """Returns the spread of an effect's part over the orders of correction, relative to the truth."""
        part = self.split.effects.get(name)
        return 0.0 if part is None else (part.greatest - part.least) / self.true(quantity).value

    def largest(self, quantity: str) -> str:
        """Returns the name of the largest part."""
        found = self.parts(quantity)
        return max(found, key=lambda name: abs(found[name]))


@dataclass(frozen=True)
class Statistics:
    """One part over set-ups, relative to each truth. `largest_in` counts where it is the greatest part, `size_there` is its median
    size among them (0 without any); `spread` is the median difference between the orders."""

    name: str
    median: float
    mean: float
    rms: float
    worst: float
    worst_case: SetUp
    largest_in: int
    size_there: float
    spread: float


def once(found: list[Entry]) -> list[Entry]:
    """Removes repeated set-ups."""
    return list({entry.set_up.id: entry for entry in found}.values())


def statistics(found: list[Entry], quantity: str) -> list[Statistics]:
    """Computes the statistics of each part over at least one set-up."""
    made = []
    for name in parts.PARTS[quantity]:
        values = np.array([entry.parts(quantity)[name] for entry in found])
        worst = int(np.argmax(np.abs(values)))
        there = [abs(value) for entry, value in zip(found, values) if entry.largest(quantity) == name]
        made.append(
            Statistics(
                name=name,
                median=float(np.median(values)),
                mean=float(np.mean(values)),
                rms=float(np.sqrt(np.mean(values**2))),
                worst=float(values[worst]),
                worst_case=found[worst].set_up,
                largest_in=len(there),
                size_there=float(np.median(there)) if there else 0.0,
                spread=float(np.median([entry.spread(name, quantity) for entry in found])),
            )
        )
    return made


def by_reference(found: list[Entry], results: Results) -> list[tuple[Entry, Entry]]:
    """Pairs the entry of each set-up that a study has solved too with the same entry under the field solver's truth."""
    pairs = []
    for entry in once(found):
        case = results.cases.get(entry.set_up.id)
        if case is not None and case.reference is not None:
            pairs.append(
                (entry, replace(entry, truth=_truth(case.reference), reached=case.reference.reached))
            )
    return pairs


def _truth(answer: ReferenceAnswer) -> Truth:
    sensor, target = answer.conductors
    return Truth(answer.mutual(sensor, target), answer.delta_self[sensor], answer.self_capacitance(target))


def truth(document: Document) -> Truth:
    """Reads a stored truth."""
    return Truth(**{name: Estimate(**value) for name, value in document.items()})


def split(document: Document) -> Split:
    """Reads a stored split."""
    effects = {name: Part(**part) for name, part in document["effects"].items()}
    return Split(document["model"], document["corrected"], document["error"], effects)


def entry(set_up: SetUp, document: Document) -> Entry:
    """Returns a set-up with its answer; one on two maps appears twice among the entries."""
    return Entry(set_up, truth(document["truth"]), split(document["split"]), document["reached"])
