"""Closed forms against ten digits of other formulas, in 30 digits: eccentricities, images one by one, another quadrature."""

from __future__ import annotations

import math

import pytest

from analysis.honesty import closed_forms

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
