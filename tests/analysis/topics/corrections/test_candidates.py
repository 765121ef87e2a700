"""The corrections that failed, which only the study computes: limits that are known, and the quadrature of two of them."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from analysis.pipeline.model_stage import model_module
from analysis.topics.corrections import candidates
from analysis.topics.corrections.fit import VACUUM_PERMITTIVITY
from analysis.topics.corrections.quadrature import adaptive_integral
from geometries.scene.poses import Pose
from geometries.scene.scene import Object, Scene
from geometries.scene.shapes import Cuboid, PlateShape
from geometries.studies import families

Array = NDArray[np.float64]
SIDE = 0.1
NAMES = tuple(each.name for each in candidates.CANDIDATES)


def before_sensor(shape: PlateShape | Cuboid, height: float) -> Scene:
    """A body over the middle of a square sensor; metres."""
    target = Object("target", shape, pose=Pose((0.0, 0.0, height)))
    return Scene(sensors=families.empty((SIDE, SIDE)).sensors, objects=(target,))


def estimates(scene: Scene, *names: str) -> dict[str, float]:
    return candidates.estimate(model_module(), scene, names)


def test_only_the_candidates_asked_for_are_computed() -> None:
    scene = before_sensor(PlateShape((SIDE, SIDE)), 0.02)
    assert set(estimates(scene, "arc", "formula")) == {"arc"}
    assert estimates(scene, "none", "formula") == {}


def test_the_module_has_none_of_them() -> None:
    assert not {str(entry["name"]) for entry in model_module().corrections()} & set(NAMES)


@pytest.mark.parametrize("shape", [PlateShape((0.08, 0.12)), Cuboid((0.08, 0.12, 0.03))])
def test_all_of_them_differ_from_the_plain_model_and_from_each_other(shape: PlateShape | Cuboid) -> None:
    found = estimates(before_sensor(shape, 0.05), *NAMES)
    plain = found["constant"] / candidates.CONSTANT
    # A wedge between parallel plates has no angle, so there the factor of `arc` is 1.
    others = {name: value for name, value in found.items() if name != "arc" or isinstance(shape, Cuboid)}
    assert len({round(value / plain, 6) for value in [plain, *others.values()]}) == len(others) + 1


def test_two_sided_arcs_of_a_sheet_far_away_come_from_both_sides() -> None:
    """At this distance the lateral offset is negligible, and so is the path around the edge."""
    found = estimates(before_sensor(PlateShape((SIDE, SIDE)), 100.0), "two-sided-arc")["two-sided-arc"]
    assert found == pytest.approx(2 * VACUUM_PERMITTIVITY * SIDE**2 / 100, rel=2e-3)


def test_reciprocity_of_equal_parallel_plates_is_the_plain_model() -> None:
    found = estimates(before_sensor(PlateShape((SIDE, SIDE)), 0.03), "reciprocity", "constant")
    assert found["reciprocity"] == pytest.approx(found["constant"] / candidates.CONSTANT, rel=1e-12)


def test_reciprocity_takes_the_nearest_face_of_a_body() -> None:
    """Above a small sensor a large box is a plane: its share is the sensor's area over the gap."""
    scene = before_sensor(Cuboid((2.0, 2.0, 0.1)), 0.07)
    found = estimates(scene, "reciprocity", "constant")
    plain = found["constant"] / candidates.CONSTANT
    assert found["reciprocity"] == pytest.approx(
        math.sqrt(plain * VACUUM_PERMITTIVITY * SIDE**2 / 0.02), rel=1e-9
    )


def test_kirchhoff_and_palmer_are_their_formulas_for_large_close_plates() -> None:
    gap = 0.002
    found = estimates(before_sensor(PlateShape((SIDE, SIDE)), gap), "kirchhoff", "palmer", "constant")
    plain = found["constant"] / candidates.CONSTANT
    radius = SIDE / math.sqrt(math.pi)
    disc = 1 + gap / (math.pi * radius) * (math.log(16 * math.pi * radius / gap) - 1)
    strip = 1 + gap / (math.pi * SIDE) * (1 + math.log(2 * math.pi * SIDE / gap))
    assert found["kirchhoff"] / plain == pytest.approx(disc, rel=1e-9)
    assert found["palmer"] / plain == pytest.approx(strip**2, rel=1e-9)


def test_the_quadrature_is_exact_for_linear_functions_and_close_at_a_kink() -> None:
    triangle = np.array([[[0.0, 0, 0], [2, 0, 0], [0, 1, 0]]])
    assert adaptive_integral(triangle, lambda points: 1 + points[:, 0]) == pytest.approx(5 / 3, rel=1e-14)

    def kink(points: Array) -> Array:
        return np.asarray(np.abs(points[:, 0] - 0.3))

    # ∫|x − c|(1 − x/2)dx from 0 to 2.
    c = 0.3
    expected = 2 / 3 - c + 2 * (c**2 / 2 - c**3 / 12)
    # The triangle's area is 1.
    assert adaptive_integral(triangle, kink) == pytest.approx(expected, abs=1e-3)
