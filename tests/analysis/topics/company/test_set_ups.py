"""Experiment VII shares its machines with the families of studies; its scenes stay what they were, and so do its stored answers."""

from __future__ import annotations

from analysis.topics.company.set_ups import MACHINES, all_set_ups

IDS = {
    "nothing": "648909c1bdaeb0c7",
    "housing": "a2fbcb6d0b22295c",
    "housing and driven guard": "fe2366d5ffa6f573",
    "table": "8ab21daf88f23167",
    "second person": "b040aa9effcc5779",
}
"""Of the third arrangement, its hand connected to the ground through 10 pF, since the experiment's first version."""


def test_the_scenes_are_those_of_the_first_version() -> None:
    found = {each.machine: each.id for each in all_set_ups() if (each.number, each.ground) == (3, "10 pF")}
    assert found == IDS and set(IDS) == set(MACHINES)
