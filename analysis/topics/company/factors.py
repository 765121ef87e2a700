"""The answers of Experiment VII as factors of the change: of each part of a machine, of the hand's connection, and of the model."""

from __future__ import annotations

from dataclasses import dataclass

from analysis.results.answers import Estimate
from analysis.results.store import Document
from analysis.topics.company.set_ups import GUARD, HOUSING, MACHINES, NOTHING, PERSON, TABLE, TO_GROUND, SetUp
from analysis.topics.spread import Spread, spread
from geometries.studies.families import FLOATING, GROUNDED

PARTS = {
    "housing": (HOUSING, NOTHING),
    "driven guard": (GUARD, HOUSING),
    "table": (TABLE, NOTHING),
    "second person": (PERSON, NOTHING),
}
"""Part of a machine → the machines with it and without it, whose changes are divided."""
CONNECTIONS = tuple(ground for ground in TO_GROUND if ground != GROUNDED)
"""The hand's connections whose changes are divided by that of the grounded hand."""
TOGETHER = "housing, hand floating"


@dataclass(frozen=True)
class Entry:
    """A set-up with value, background and change of its reading; `model` is the model's change, None unless the hand is grounded (F)."""

    set_up: SetUp
    value: Estimate
    background: Estimate
    change: Estimate
    model: float | None


@dataclass(frozen=True)
class Ratio:
    """A change over another one, of two set-ups that differ in one respect; `error` is relative, `id` is the first set-up's."""

    id: str
    value: float
    error: float


@dataclass(frozen=True)
class Factor:
    """The ratios of all set-ups that differ in `what` from those without it (`against`)."""

    what: str
    against: str
    ratios: tuple[Ratio, ...]

    @property
    def spread(self) -> Spread:
        """How the ratios are spread, of which there must be one."""
        found = spread(ratio.value for ratio in self.ratios)
        assert found is not None
        return found

    @property
    def error(self) -> float:
        """The largest relative error of a ratio."""
        return max(ratio.error for ratio in self.ratios)


def factors(found: list[Entry]) -> list[Factor]:
    """Returns what each part of a machine, and each connection of the hand but the grounded one, makes of the change; those
    for which there is any pair of set-ups."""
    made = [of_part(found, part, tuple(TO_GROUND)) for part in PARTS]
    made += [of_connection(found, ground, MACHINES) for ground in CONNECTIONS]
    made.append(Factor(TOGETHER, "neither", _ratios(found, (HOUSING, FLOATING), (NOTHING, GROUNDED))))
    return [factor for factor in made if factor.ratios]


def of_part(found: list[Entry], part: str, grounds: tuple[str, ...]) -> Factor:
    """Returns what a part of a machine makes of the change, over some connections of the hand; perhaps without any ratio."""
    machine, without = PARTS[part]
    ratios = (ratio for ground in grounds for ratio in _ratios(found, (machine, ground), (without, ground)))
    return Factor(part, "without it", tuple(ratios))


def of_connection(found: list[Entry], ground: str, machines: tuple[str, ...]) -> Factor:
    """Returns what the hand's connection makes of the change, over some machines; perhaps without any ratio."""
    ratios = (
        ratio for machine in machines for ratio in _ratios(found, (machine, ground), (machine, GROUNDED))
    )
    return Factor(_hand(ground), "grounded", tuple(ratios))


def of_model(found: list[Entry], machine: str, ground: str) -> Factor:
    """Returns the model's change, that of the grounded hand, over the true one; perhaps without any ratio."""
    by_model = {
        (entry.set_up.number, entry.set_up.machine): entry.model for entry in found if entry.model is not None
    }
    ratios = []
    for entry in _of(found, machine, ground).values():
        model = by_model.get((entry.set_up.number, machine))
        if model is not None:
            true = entry.change
            ratios.append(Ratio(entry.set_up.id, model / true.value, true.error / true.value))
    return Factor(f"{machine}, {_hand(ground)}", "truth", tuple(ratios))


def _hand(ground: str) -> str:
    return f"hand {ground}" if ground in (GROUNDED, FLOATING) else f"hand through {ground}"


def _ratios(found: list[Entry], these: tuple[str, str], those: tuple[str, str]) -> tuple[Ratio, ...]:
    """Divides the changes of a machine and a connection by those of others, arrangement by arrangement."""
    above, below = _of(found, *these), _of(found, *those)
    return tuple(_ratio(above[number], below[number]) for number in sorted(above.keys() & below.keys()))


def _ratio(entry: Entry, other: Entry) -> Ratio:
    above, below = entry.change, other.change
    # Both errors may have the same cause or opposite ones: their sizes are added.
    error = above.error / above.value + below.error / below.value
    return Ratio(entry.set_up.id, above.value / below.value, error)


def _of(found: list[Entry], machine: str, ground: str) -> dict[int, Entry]:
    return {
        entry.set_up.number: entry
        for entry in found
        if entry.set_up.machine == machine and entry.set_up.ground == ground
    }


def entry(set_up: SetUp, document: Document) -> Entry:
    """Returns a set-up with its answer."""
    value, background, change = (Estimate(**document[name]) for name in ("value", "background", "change"))
    return Entry(set_up, value, background, change, document["model"])
