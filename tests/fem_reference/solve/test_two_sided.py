"""Differences from both bounds: exact where the errors of both scenes are equal, and with an error where they are not."""

from __future__ import annotations

import numpy as np
import pytest

from fem_reference import maxwell
from fem_reference.solve.two_sided import FRACTION_OF_DISTANCE, FRACTION_OF_WIDTHS, two_sided, unit_voltages
from geometries.scene.reader import loads

SQUARE = """
[[sensor]]
name = "front"
plates = [ { corner = [-0.05, -0.05, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] } ]
"""
OTHER_SQUARE = """
[[object]]
name = "target"
shape = {{ type = "plate", size = [0.1, 0.1] }}
translation = [0, 0, {gap}]
"""


def positive(random: np.random.Generator, size: float) -> np.ndarray:
    """A positive semidefinite matrix."""
    root = random.normal(size=(3, 3))
    return np.asarray(size * root @ root.T)


def test_errors_that_both_scenes_have_cancel() -> None:
    """What is left is a share of the widths, since the two differences may agree by chance."""
    random = np.random.default_rng(1)
    matrix, around, wrong = positive(random, 1.0), positive(random, 0.5), positive(random, 0.01)
    own = np.eye(3)
    found = two_sided(own, own, (matrix - wrong, matrix + wrong), (around - wrong, around + wrong), 1.0, 0.0)
    np.testing.assert_allclose(found.value, np.diag(matrix - around), rtol=1e-12)
    np.testing.assert_allclose(found.error, 4 * FRACTION_OF_WIDTHS * np.diag(wrong), rtol=1e-9)


def test_errors_of_one_scene_only_are_stated() -> None:
    """Off the diagonal they count even where the two differences agree because the errors of the two conductors have no product."""
    matrix, wrong = 2 * np.eye(2), np.diag([0.1, 0.2])
    sensed, driven = unit_voltages(2, [[0], [0]]), unit_voltages(2, [[0], [1]])
    exact = (np.eye(2), np.eye(2))
    found = two_sided(sensed, driven, (matrix - wrong, matrix + wrong), exact, np.array([1.0, -1.0]), 0.0)
    np.testing.assert_allclose(found.value, [1, 0], atol=1e-12)
    share = FRACTION_OF_DISTANCE + FRACTION_OF_WIDTHS
    np.testing.assert_allclose(found.error, [0.2 * share, 2 * np.sqrt(0.1 * 0.2) * share])


@pytest.mark.parametrize("gap", [0.02, 0.05, 0.2])
def test_one_mesh_gives_the_change_within_its_error(gap: float) -> None:
    """Against three meshes, which are extrapolated; the error stated for one mesh is a fraction of its interval's width."""
    scene = loads(SQUARE + OTHER_SQUARE.format(gap=gap))
    one = maxwell(scene, rtol=1e-2, max_unknowns=1)
    three = maxwell(scene, rtol=1e-3, error="estimate")
    assert len(one.levels) == 1 and len(three.levels) >= 3 and one.enclosure is not None
    difference = np.abs(one.delta_self.value - three.delta_self.value)
    assert np.all(difference <= one.delta_self.error + three.delta_self.error)
    assert one.delta_self.error[0] < one.enclosure.half_width[0, 0]
    print(
        f"\ngap {gap}: off by {difference / one.delta_self.value}, stated {one.delta_self.error / one.delta_self.value}"
    )
