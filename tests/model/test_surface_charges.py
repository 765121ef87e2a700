"""Charges and potentials at points against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.pipeline.model_stage import model_module

TWO = """
[[object]]
name = "ball"
shape = { type = "sphere", radius = 0.1, segments = 24 }
potential = "electrode"
[[object]]
name = "wall"
shape = { type = "cube", size = 0.05 }
translation = [0.3, 0, 0]
"""


def test_the_potential_is_that_of_the_conductors_on_them_and_of_their_charge_far_away() -> None:
    fringe = model_module()
    found = fringe.Scene.loads(TWO).surface_charges(rtol=0.003, most_panels=3000)
    assert found["conductors"] == ["ball", "wall"] and found["error"] < 0.02
    charges = found["charges"][:, 0]
    points = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.0, 50.0, 0.0]])
    potentials = fringe.triangle_potentials(points, found["panels"]) @ charges
    assert potentials[:2] == pytest.approx([1, 0], abs=6e-3)
    assert potentials[2] == pytest.approx(charges.sum() / 50, rel=1e-3)


def test_the_charges_have_the_potentials_asked_for_far_more_exactly_than_their_energies_need(
    sensor_before_a_housing: str,
) -> None:
    """The energies' error is the square of the charges', which decide about potentials far away."""
    fringe = model_module()
    rtol = 0.01
    found = fringe.Scene.loads(sensor_before_a_housing).surface_charges(rtol=rtol)
    potentials = fringe.single_layer(found["panels"], 1e-6) @ found["charges"][:, 0]
    errors = potentials - (np.array(found["conductor_of"]) == found["conductors"].index("front"))
    assert np.sqrt((errors**2).mean()) < 0.02 * rtol


def test_means_of_1_over_r_are_those_of_the_single_layer() -> None:
    """The mean over all pairs of points of an equilateral triangle is 4 ln 3 over its side."""
    fringe = model_module()
    side = np.array([[0, 0, 0], [1, 0, 0], [0.5, np.sqrt(3) / 2, 0]])
    apart = np.array([side, side + [0, 0, 0.5], side + [9, 0, 0]])
    matrix = fringe.single_layer(apart)
    np.testing.assert_allclose(matrix, matrix.T)
    assert matrix[0, 0] == pytest.approx(4 * np.log(3), rel=1e-12)
    centres = apart.mean(axis=1)
    means = fringe.triangle_potentials(centres, apart)
    assert means.dtype == np.float32 and means[0, 2] == pytest.approx(matrix[0, 2], rel=2e-3)
