"""Random scenes: every kind can be read, a seed stands for one scene, and each kind has what it is named for."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest

from analysis.honesty import closed_scenes, kinds, other_scenes
from analysis.honesty.kinds import KINDS
from geometries.scene import reader
from geometries.scene.scene import Scene

EACH = 6


def scenes(kind: str, folder: Path) -> list[Scene]:
    first = list(KINDS).index(kind)
    return [
        reader.loads(kinds.drawn(seed, folder).text)
        for seed in range(first, first + EACH * len(KINDS), len(KINDS))
    ]


@pytest.mark.parametrize("kind", KINDS)
def test_a_seed_stands_for_a_scene_that_can_be_read(kind: str, tmp_path: Path) -> None:
    first = list(KINDS).index(kind)
    for seed in range(first, first + EACH * len(KINDS), len(KINDS)):
        made = kinds.drawn(seed, tmp_path)
        assert made.kind == kind and made == kinds.drawn(seed, tmp_path)
        scene = reader.loads(made.text)
        assert bool(made.truths) == (kind == "closed-forms")
        assert made.has_readings == bool(scene.sensors or scene.readings)
        finer = reader.loads(made.finer)
        assert [body.name for body in finer.objects] == [body.name for body in scene.objects]


def test_seeds_are_those_of_the_kinds() -> None:
    chosen = kinds.seeds(20, frozenset({"plates", "robots"}))
    found = [next(chosen) for _ in range(4)]
    assert min(found) >= 20 and {kinds.kind_of(seed) for seed in found} == {"plates", "robots"}


def test_kinds_have_what_they_are_named_for(tmp_path: Path) -> None:
    permittivities = [
        body.relative_permittivity
        for scene in scenes("insulators", tmp_path)
        for body in scene.objects
        if body.relative_permittivity is not None
    ]
    assert len(permittivities) == EACH and max(permittivities) > 1e3
    assert all(scene.links and scene.sensors for scene in scenes("robots", tmp_path))
    assert not any(scene.sensors for scene in scenes("no-sensors", tmp_path))
    assert all(
        any(body.potential == "floating" for body in scene.objects) for scene in scenes("floating", tmp_path)
    )
    assert all(
        any(reading.sense not in reading.drive for reading in scene.readings)
        for kind in ("guards", "transmit")
        for scene in scenes(kind, tmp_path)
    )
    assert all(
        any(body.conductor in ("front", "beside") for body in scene.objects)
        for scene in scenes("covers", tmp_path)
    )


def test_every_closed_form_is_drawn(tmp_path: Path) -> None:
    for form in closed_scenes.FORMS:
        known = form(random.Random(3), tmp_path)
        assert known.truths and all(each.error < 1e-2 * abs(each.value) for each in known.truths.values())


def test_what_is_revolved_is_closed_and_faces_outwards() -> None:
    triangles = other_scenes.revolved([(0.0, -1.0), (1.0, -1.0), (1.0, 1.0), (0.0, 1.0)], 96)
    a, b, c = (triangles[:, corner] for corner in range(3))
    volume = float(np.sum(np.cross(a, b) * c) / 6)
    assert volume == pytest.approx(2 * np.pi, rel=1e-2)
