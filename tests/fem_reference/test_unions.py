"""Conductors of several bodies: however an L is put together, its matrix is the same within the stated errors."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.constants import epsilon_0

from analysis.topics.verification.truths import UNIT_CUBE
from fem_reference import maxwell
from fem_reference.answer.reference import Reference
from fem_reference.bodies.wrapping import Geometry
from fem_reference.output.documents import document, table
from geometries.scene import meshes
from geometries.scene.reader import loads
from geometries.scene.shapes import Cuboid
from tests import scenes
from tests.fem_reference.problems import prism
from tests.scenes import SENSOR


def foot_and_post(height: float, middle: float) -> str:
    """A sensor below an L that is a foot with a post on it, of this height around this middle."""
    foot = scenes.body("foot", "cuboid", size=[0.1, 0.04, 0.04], translation=[0, 0, 0.06])
    post = scenes.body("post", "cuboid", size=[0.04, 0.04, height], translation=[0.03, 0, middle])
    return SENSOR + foot + post


def mesh(folder: Path, triangles: np.ndarray, potential: str = "grounded") -> str:
    meshes.write(triangles, folder / "foot.ply")
    return scenes.body("foot", "mesh", potential=potential, file=str(folder / "foot.ply"))


def outline() -> np.ndarray:
    """The triangles of the L as one clean mesh."""
    corners = [[0.04, 0.05], [0.04, -0.05], [0.08, -0.05], [0.08, 0.01], [0.14, 0.01], [0.14, 0.05]]
    z, x, y = prism(np.array(corners)).transpose(2, 0, 1)
    return np.stack([x, 0.04 * (y - 0.5), z], axis=2)


@cache
def touching() -> Reference:
    """One level is enclosed; the limit of time ends it there."""
    return maxwell(loads(foot_and_post(0.06, 0.11)), rtol=1e-2, max_seconds=1e-3)


def checked(scene: str) -> Reference:
    """One level with estimated errors, whose bounds are wider and cost an eighth of those of `touching`."""
    return maxwell(loads(scene), rtol=1e-2, max_seconds=1e-3, error="estimate")


def agree(found: Reference) -> None:
    """Both intervals contain the truth, and so overlap; the values differ by no more than the errors."""
    other = touching()
    assert found.names == other.names
    assert found.levels[0].bounds is not None
    bounds = found.enclosure or found.levels[0].bounds.interval
    assert np.all(bounds.lower <= other.upper) and np.all(other.lower <= bounds.upper)
    difference = np.abs(found.maxwell.value - other.maxwell.value)
    assert np.all(difference <= found.maxwell.error + other.maxwell.error)
    print(f"\ndifference {np.max(difference / np.abs(other.maxwell.value)):.1e}, stated {found.worst:.1e}")


def test_touching_boxes_are_one_conductor_with_a_charge_on_each() -> None:
    found = touching()
    told = document(found)
    assert told["conductors"] == ["front", "foot"] and told["members"] == [["front"], ["foot", "post"]]
    assert found.worst <= 1e-2 and "one conductor: foot, post" in table(found)
    for charges, row in zip(told["charges"], told["maxwell"]):
        np.testing.assert_allclose(np.sum(charges, axis=0), row, rtol=1e-12)
    foot, post = told["charges"][1]
    assert foot[0] < post[0] < 0, "the foot is nearer to the sensor, and shields the post"
    assert foot[1] > post[1] > 0


def test_overlapping_boxes_have_the_same_matrix() -> None:
    found = checked(foot_and_post(0.09, 0.095))
    agree(found)
    np.testing.assert_allclose(found.levels[0].maxwell, touching().levels[0].maxwell, rtol=1e-3)


def test_a_clean_mesh_has_the_same_matrix(tmp_path: Path) -> None:
    found = checked(SENSOR + mesh(tmp_path, outline()))
    agree(found)
    np.testing.assert_allclose(found.levels[0].maxwell, touching().levels[0].maxwell, rtol=1e-3)
    assert found.problem.wraps == () and found.geometry is None


@pytest.mark.night
def test_an_unclean_mesh_has_the_same_matrix(tmp_path: Path) -> None:
    """Every third triangle is flipped, some are there twice, and one ends in the middle of its neighbour's side: the mesh is wrapped.

    What the wrap costs is stated, and the bounds that remain proven are not widened by it.
    """
    clean = outline()
    dirty = np.where((np.arange(len(clean)) % 3 == 0)[:, None, None], clean[:, ::-1], clean)
    a, b, c = dirty[-1]
    halves = [[a, (a + b) / 2, c], [(a + b) / 2, b, c]]
    scene = loads(SENSOR + mesh(tmp_path, np.concatenate([dirty[:-1], halves, clean[:2]])))
    found = maxwell(scene, rtol=1e-2, max_seconds=1e-3, geometry=Geometry(alpha=0.03))
    agree(found)
    told = document(found)
    assert told["members"] == [["front"], ["foot"]] and told["wrapped"][0]["members"] == ["foot"]
    cost = np.array(told["geometry_error"])
    off = np.abs(found.maxwell.value - touching().maxwell.value)
    assert np.all(cost > 0) and np.all(off < cost + found.maxwell.error + touching().maxwell.error)
    assert np.all(cost < 0.05 * np.abs(found.maxwell.value))
    proven = told["proven"]
    assert proven["upper"] == [[True, False], [False, True]]
    assert proven["lower"] == [[False, True], [True, False]]
    assert found.levels[0].enclosure is not None
    np.testing.assert_array_equal(np.diag(found.upper), np.diag(found.levels[0].enclosure.upper))
    assert found.lower[0, 1] == found.levels[0].enclosure.lower[0, 1]
    assert np.all(np.diag(found.upper) >= np.diag(touching().lower))
    assert "wrapped: foot" in table(found) and "largest relative error due to the wraps" in table(found)


def test_a_wrapped_body_by_itself_has_its_capacitance(tmp_path: Path) -> None:
    """A cube with a triangle too many, and nothing else in the scene: the wrap has no neighbour that its lengths could follow."""
    edge = 0.04
    cube = Cuboid((edge, edge, edge)).triangles()
    found = maxwell(loads(mesh(tmp_path, np.concatenate([cube, cube[:1]]), "electrode")), rtol=2e-2)
    truth = UNIT_CUBE * 4 * np.pi * epsilon_0 * edge
    assert found.problem.wraps[0].members == ("foot",)
    assert abs(found.maxwell.value[0, 0] - truth) <= found.maxwell.error[0, 0] <= 2e-2 * truth
    assert found.lower[0, 0] <= truth <= found.upper[0, 0]
