"""Set-ups of Experiment VIII with the true change of their reading and the model's, and what insulators make of both."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from analysis.results.answers import Estimate
from analysis.results.store import Document
from analysis.topics.insulators.set_ups import COUNTS, SetUp
from analysis.topics.insulators.stage import IGNORING, REDUCED
from analysis.topics.insulators.truths import Truths, read
from analysis.topics.spread import Spread, spread


@dataclass(frozen=True, eq=False)
class Entry:
    """A set-up; `changes` holds the change (F) by the reduced method, with the insulator and without it, where it answers."""

    set_up: SetUp
    true: Truths
    changes: dict[str, Estimate]
    pairs: dict[str, float]

    @property
    def factor(self) -> float:
        """The true change with the insulator over that without it; of an insulating target over that of a grounded one."""
        return self.true.insulated.change.value / self.true.without.change.value

    @property
    def uncertainty(self) -> float:
        """The relative error of the factor."""
        return sum(
            each.change.error / abs(each.change.value) for each in (self.true.insulated, self.true.without)
        )

    @property
    def false_change(self) -> float:
        """What the insulator alone adds to the reading, over the change by the hand without it."""
        added = self.true.insulated.background.value - self.true.without.background.value
        return added / self.true.without.change.value

    def error(self, method: str) -> float:
        """Returns a change by the reduced method over the true one with the insulator, less one."""
        return self.changes[method].value / self.true.insulated.change.value - 1

    @property
    def is_enclosed(self) -> bool:
        """Tells whether the true change lies within the error that the reduced method states."""
        found, true = self.changes[REDUCED], self.true.insulated.change
        return abs(found.value - true.value) <= found.error + true.error


def by_family(found: list[Entry]) -> dict[str, list[Entry]]:
    """Returns the entries of each family that has any."""
    families = {family: [entry for entry in found if entry.set_up.family == family] for family in COUNTS}
    return {family: members for family, members in families.items() if members}


def errors(found: Iterable[Entry], method: str) -> Spread | None:
    """Returns the statistics of the reduced method's relative errors, of those entries for which it has an answer."""
    return spread(entry.error(method) for entry in found if method in entry.changes)


def entry(set_up: SetUp, answer: Document) -> Entry:
    """Returns a set-up with its answer."""
    changes = {
        name: Estimate(**answer["changes"][name])
        for name in (REDUCED, IGNORING)
        if "refused" not in answer["changes"][name]
    }
    return Entry(set_up, read(answer["truths"]), changes, answer["pairs"])
