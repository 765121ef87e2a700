"""Random scenes: every kind can be read, a seed stands for one scene; closed forms against ten digits of other formulas, in 30 digits."""

import math
import random
from pathlib import Path

import numpy as np
import pytest

from analysis.honesty import closed_forms, kinds, scenes
from analysis.honesty.kinds import KINDS, Drawn
from geometries.scene import reader
from geometries.scene.scene import Scene

EACH = 6


def all_drawn(kind: str, folder: Path) -> list[Drawn]:
    first, step = list(KINDS).index(kind), len(KINDS)
    return [kinds.drawn(seed, folder) for seed in range(first, first + EACH * step, step)]


def scenes_of(kind: str, folder: Path) -> list[Scene]:
    return [reader.loads(each.text) for each in all_drawn(kind, folder)]


@pytest.mark.parametrize("kind", KINDS)
def test_a_seed_stands_for_a_scene_that_can_be_read(kind: str, tmp_path: Path) -> None:
    for made in all_drawn(kind, tmp_path):
        assert made.kind == kind and made == kinds.drawn(made.seed, tmp_path)
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
        for scene in scenes_of("insulators", tmp_path)
        for body in scene.objects
        if body.relative_permittivity is not None
    ]
    assert len(permittivities) == EACH and max(permittivities) > 1e3
    assert all(scene.links and scene.sensors for scene in scenes_of("robots", tmp_path))
    assert not any(scene.sensors for scene in scenes_of("no-sensors", tmp_path))
    assert all(
        any(body.potential == "floating" for body in scene.objects)
        for scene in scenes_of("floating", tmp_path)
    )
    assert all(
        any(reading.sense not in reading.drive for reading in scene.readings)
        for kind in ("guards", "transmit")
        for scene in scenes_of(kind, tmp_path)
    )
    assert all(
        any(body.conductor in ("front", "beside") for body in scene.objects)
        for scene in scenes_of("covers", tmp_path)
    )


def test_every_closed_form_is_drawn(tmp_path: Path) -> None:
    for form in closed_forms.FORMS:
        known = form(random.Random(3), tmp_path)
        assert known.truths and all(each.error < 1e-2 * abs(each.value) for each in known.truths.values())


def test_what_is_revolved_is_closed_and_faces_outwards() -> None:
    triangles = scenes.revolved([(0.0, -1.0), (1.0, -1.0), (1.0, 1.0), (0.0, 1.0)], 96)
    a, b, c = (triangles[:, corner] for corner in range(3))
    volume = float(np.sum(np.cross(a, b) * c) / 6)
    assert volume == pytest.approx(2 * np.pi, rel=1e-2)


DIGITS = 1e-10
KNOWN = {
    "a ball": (closed_forms.of_ellipsoid(1, 1, 1), 1.0),
    "a disc": (closed_forms.of_ellipsoid(1, 1, 0), 2 / math.pi),
    "a flat ellipsoid": (closed_forms.of_ellipsoid(1, 1, 0.01), 0.6406666189),
    "a long ellipsoid": (closed_forms.of_ellipsoid(1, 0.01, 0.01), 0.1887306192),
    "an ellipsoid of three axes": (closed_forms.of_ellipsoid(3, 2, 1), 1.9660092007),
    "two balls, nearly touching": (closed_forms.of_two_spheres(1, 1, 0.01), (2.1366708264, 2.1366708264, -1.4427860423)),
    "two balls, one larger": (closed_forms.of_two_spheres(1, 2, 0.5), (1.3448794651, 2.5029295041, -0.7963687577)),
    "two balls, one smaller": (closed_forms.of_two_spheres(1, 0.25, 0.03), (1.3270916837, 0.4670894056, -0.3861651604)),
    "two discs": (closed_forms.of_coaxial_discs(1, 0.5), (1.0503333101, -0.6555369923)),
    "two near discs": (closed_forms.of_coaxial_discs(1, 0.1), (3.1095575189, -2.7684040781)),
    "two larger discs": (closed_forms.of_coaxial_discs(2, 0.2), tuple(2 * c for c in closed_forms.of_coaxial_discs(1, 0.1))),
    "a bowl": (closed_forms.of_bowl(1, math.pi / 3), 0.6089977810),
    "a bowl that is closed": (closed_forms.of_bowl(1, math.pi), 1.0),
    "a bowl that is flat": (closed_forms.of_bowl(1e5, 1e-5), 2 / math.pi),
    "a layer": (closed_forms.of_coated_sphere(1, 1.1, 3), 1.0645161290),
    "a layer of no thickness": (closed_forms.of_coated_sphere(1, 1, 3), 1.0),
    "a layer of the medium": (closed_forms.of_coated_sphere(1, 2, 1), 1.0),
    "a layer as good as metal": (closed_forms.of_coated_sphere(1, 2, 1e12), 2.0),
    "two balls that cross": (closed_forms.of_crossing_spheres(1, 1), 2 - 1 / math.sqrt(2)),
    "a ball with a speck": (closed_forms.of_crossing_spheres(1, 1e-11), 1.0),
}  # fmt: skip


@pytest.mark.parametrize("name", KNOWN)
def test_closed_forms_have_the_digits_of_other_formulas_and_the_limits_that_are_known(name: str) -> None:
    found, expected = KNOWN[name]
    assert found == pytest.approx(expected, abs=DIGITS)


@pytest.mark.parametrize(("a", "b", "gap"), [(1, 1, 0.5), (1, 0.3, 0.1), (1, 3, 1)])
def test_an_insulator_is_nothing_or_floats_at_the_ends_of_permittivity(
    a: float, b: float, gap: float
) -> None:
    own, other, between = closed_forms.of_two_spheres(a, b, gap)
    assert closed_forms.beside_insulator(a, b, gap, 1) == pytest.approx(a, abs=DIGITS)
    floating = own - between**2 / other
    assert closed_forms.beside_insulator(a, b, gap, 1e15) == pytest.approx(floating, abs=1e-9)
