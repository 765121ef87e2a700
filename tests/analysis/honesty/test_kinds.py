"""Random scenes: every kind can be read, a seed stands for one scene; closed forms against ten digits of other formulas, in 30 digits."""

from __future__ import annotations

import math
import random
from pathlib import Path

import numpy as np
import pytest

from analysis.honesty import closed_forms, closed_scenes, kinds, other_scenes
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


DIGITS = 1e-10


@pytest.mark.parametrize(
    ("axes", "expected"),
    [
        ((1, 1, 1), 1.0),
        ((1, 1, 0), 2 / math.pi),
        ((1, 1, 0.01), 0.6406666189),
        ((1, 0.01, 0.01), 0.1887306192),
        ((3, 2, 1), 1.9660092007),
    ],
)
def test_ellipsoids(axes: tuple[float, float, float], expected: float) -> None:
    assert closed_forms.ellipsoid(*axes) == pytest.approx(expected, abs=DIGITS)


@pytest.mark.parametrize(
    ("a", "b", "gap", "expected"),
    [
        (1, 1, 0.01, (2.1366708264, 2.1366708264, -1.4427860423)),
        (1, 2, 0.5, (1.3448794651, 2.5029295041, -0.7963687577)),
        (1, 0.25, 0.03, (1.3270916837, 0.4670894056, -0.3861651604)),
    ],
)
def test_two_spheres(a: float, b: float, gap: float, expected: tuple[float, float, float]) -> None:
    assert closed_forms.two_spheres(a, b, gap) == pytest.approx(expected, abs=DIGITS)


@pytest.mark.parametrize(
    ("gap", "expected"), [(0.5, (1.0503333101, -0.6555369923)), (0.1, (3.1095575189, -2.7684040781))]
)
def test_coaxial_discs(gap: float, expected: tuple[float, float]) -> None:
    assert closed_forms.coaxial_discs(1, gap) == pytest.approx(expected, abs=DIGITS)
    assert closed_forms.coaxial_discs(2, 2 * gap) == pytest.approx([2 * each for each in expected], abs=1e-9)


def test_a_bowl_ends_as_a_disc_and_as_a_sphere() -> None:
    assert closed_forms.bowl(1, math.pi) == pytest.approx(1, abs=DIGITS)
    flat = 1e-4
    assert closed_forms.bowl(1 / flat, flat) == pytest.approx(2 / math.pi, rel=1e-8)
    assert closed_forms.bowl(1, math.pi / 3) == pytest.approx(0.6089977810, abs=DIGITS)


def test_a_layer_without_thickness_or_of_the_mediums_permittivity_is_none() -> None:
    assert closed_forms.coated_sphere(1, 1, 3) == pytest.approx(1, abs=DIGITS)
    assert closed_forms.coated_sphere(1, 2, 1) == pytest.approx(1, abs=DIGITS)
    assert closed_forms.coated_sphere(1, 2, 1e12) == pytest.approx(2, abs=DIGITS)
    assert closed_forms.coated_sphere(1, 1.1, 3) == pytest.approx(1.0645161290, abs=DIGITS)


def test_spheres_that_cross_have_at_least_the_larger_ones() -> None:
    assert closed_forms.crossing_spheres(1, 1) == pytest.approx(2 - 1 / math.sqrt(2), abs=DIGITS)
    assert closed_forms.crossing_spheres(1, 1e-9) == pytest.approx(1, abs=1e-8)


@pytest.mark.parametrize(("a", "b", "gap"), [(1, 1, 0.5), (1, 0.3, 0.1), (1, 3, 1)])
def test_an_insulator_is_nothing_or_floats_at_the_ends_of_permittivity(
    a: float, b: float, gap: float
) -> None:
    own, other, between = closed_forms.two_spheres(a, b, gap)
    assert closed_forms.beside_insulator(a, b, gap, 1) == pytest.approx(a, abs=DIGITS)
    assert closed_forms.beside_insulator(a, b, gap, 1e15) == pytest.approx(
        own - between**2 / other, abs=1e-9
    )


def test_a_cube_is_published() -> None:
    assert closed_forms.cube(2) == pytest.approx(2 * 0.6606781541, abs=DIGITS)
