"""The parts of the model's error: path integrals against closed forms and another quadrature, sums that come out, set-ups and pages."""

import math
import re
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.constants import epsilon_0

from analysis.pipeline import model_stage
from analysis.results.answers import Estimate
from analysis.results.set_up import Rectangle, describe, rectangles
from analysis.results.table import MUTUAL
from analysis.study import report
from analysis.topics.errors import parts, set_ups
from analysis.topics.errors.parts import BACK, EFFECTS, LATERAL, PARTS, RECIPROCITY, TILT
from analysis.topics.errors.set_ups import MAPS, Entry, SetUp, all_set_ups
from analysis.topics.errors.topic import ABSENT, ERRORS as TOPIC
from geometries.common.arrays import Array
from geometries.scene.scene import Scene
from geometries.studies import families
from tests.analysis.synthetic import make_results, report_text


SQUARE = (0.1, 0.1)
CHORD = parts.Stretch(1.0, 1.0)
BOTH = parts.Stretch(1.3, math.pi / 2)


@pytest.fixture(scope="module")
def model() -> Any:
    return model_stage.model_module()


def plates(scene: Scene) -> tuple[Rectangle, Rectangle]:
    found = rectangles(scene)
    assert found is not None
    return found


TURNED = families.corner(SQUARE, (0.06, 0.04), (0.01, 0.02), 0.015, tilt_degrees=30, turn_degrees=25)
ASTRIDE = families.straddle(SQUARE, (0.12, 0.05), 0.02, (0.04, 0.03), tilt_degrees=20, turn_degrees=70)


def length(points: Array, stretch: parts.Stretch) -> Array:
    """L of points (..., 3) to the square sensor, which is centred at the origin in z = 0."""
    half = SQUARE[0] / 2
    beside = points[..., :2] - np.clip(points[..., :2], -half, half)
    lateral = stretch.lateral * np.linalg.norm(beside, axis=-1)
    return np.asarray(np.hypot(stretch.normal * points[..., 2], lateral))


@pytest.mark.parametrize("scene", [TURNED, ASTRIDE])
@pytest.mark.parametrize("stretch", [CHORD, BOTH])
def test_path_integrals_are_those_of_a_plain_rule(model: Any, scene: Scene, stretch: parts.Stretch) -> None:
    """The middles of 1000 × 1000 equal pieces, each mirrored at the four edges."""
    sensor, target = plates(scene)
    width, depth = np.linalg.norm(target.edge_u), np.linalg.norm(target.edge_v)
    middles = (np.arange(1000) + 0.5) / 1000
    a, b = np.meshgrid(middles, middles, indexing="ij")

    def from_(u: Array, v: Array) -> Array:
        return length(target.corner + u[..., None] * target.edge_u + v[..., None] * target.edge_v, stretch)

    around = [
        math.pi * width * a + from_(-a, b),
        math.pi * width * (1 - a) + from_(2 - a, b),
        math.pi * depth * b + from_(a, -b),
        math.pi * depth * (1 - b) + from_(a, 2 - b),
    ]
    front, back = parts.front(model, target, sensor, stretch), parts.back(target, sensor, stretch)
    assert front.value == pytest.approx(width * depth * np.mean(1 / from_(a, b)), rel=1e-5)
    assert back.value == pytest.approx(width * depth * np.mean(1 / np.min(around, axis=0)), rel=3e-4)
    assert 0 == front.error < back.error < 1e-3 * back.value


@pytest.mark.parametrize("degrees", [5.0, 30.0, 60.0])
def test_arcs_between_plates_of_a_wedge_are_exact(model: Any, degrees: float) -> None:
    """Whatever θ: a plate above the sensor alone, from r1 to r2 of the wedge's edge, has ∫dA/(rθ) = width/θ·ln(r2/r1)."""
    angle, hinge, side = math.radians(degrees), 0.002, 0.03
    sensor, target = plates(families.inclined(SQUARE, (side, 0.04), hinge, degrees))
    first = hinge / math.sin(angle)
    stretch = parts.Stretch(parts.arc_over_chord(target, sensor), 1.0)
    expected = 0.04 / angle * math.log((first + side) / first)
    assert parts.front(model, target, sensor, stretch).value == pytest.approx(expected, rel=1e-12)


def test_the_model_without_effects_is_the_model(model: Any) -> None:
    sensor, target = plates(TURNED)
    triangles = TURNED.conductors()["target"]
    expected = epsilon_0 * model.plate_integral(triangles, sensor.corner, sensor.edge_u, sensor.edge_v).sum()
    assert parts.split(model, sensor, target).model == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("scene", [TURNED, ASTRIDE])
def test_the_corrected_formula_is_reciprocal(model: Any, scene: Scene) -> None:
    sensor, target = plates(scene)
    there, back = parts.split(model, sensor, target), parts.split(model, target, sensor)
    assert there.corrected == pytest.approx(back.corrected, rel=1e-12)
    assert abs(there.model / back.model - 1) > 0.01


def test_effects_that_cannot_matter_have_no_part(model: Any) -> None:
    equal = parts.split(model, *plates(families.parallel(SQUARE, SQUARE, 0.02)))
    assert equal.effects[TILT] == parts.Part(0.0, 0.0, 0.0)
    assert abs(equal.effects[RECIPROCITY].value) < 1e-12 * equal.model
    assert equal.effects[BACK].value < 0 and equal.effects[LATERAL].value >= 0


def test_shares_by_hand() -> None:
    """a is worth 1, b nothing by itself, both 4: the orders give a 1 or 4 and b 3 or 0."""
    worth = {frozenset(): 0.0, frozenset("a"): -1.0, frozenset("b"): 0.0, frozenset("ab"): -4.0}
    found = parts.shares("ab", lambda joined: worth[joined])
    assert found == {"a": parts.Part(2.5, 1.0, 4.0), "b": parts.Part(1.5, 0.0, 3.0)}


def test_what_the_difference_of_the_quantities_is_made_of() -> None:
    truth = parts.Truth(Estimate(4.0, 0.0), Estimate(3.5, 0.0), Estimate(8.0, 0.0))
    assert parts.drawn_from_infinity(truth) == 2.0 and parts.polarisation(truth) == -1.5


def some() -> tuple[SetUp, ...]:
    """One in the middle of every map and its farthest, one of each family of the default study, a random one."""
    found = []
    for group in MAPS:
        members = sorted((each for each in all_set_ups() if each.group == group), key=lambda s: s.place or ())
        found += [members[len(members) // 2], members[-1]]
    own = [each for each in all_set_ups() if each.group == set_ups.DEFAULT]
    found += {each.family: each for each in own}.values()
    return (*found, next(each for each in all_set_ups() if each.group == set_ups.RANDOM))


def test_there_are_hundreds_of_all_families_and_in_random_poses() -> None:
    assert len({each.id for each in all_set_ups()}) >= 300
    families = Counter(each.family for each in all_set_ups())
    assert set(families) == {"parallel", "inclined", "edge", "corner", "straddle", "random"}
    assert families["random"] >= 100


def test_random_plates_keep_their_distance_and_are_turned_all_ways() -> None:
    tilts = []
    for each in all_set_ups():
        described, plates = describe(each.scene), rectangles(each.scene)
        assert described is not None and plates is not None
        if each.group == set_ups.RANDOM:
            sides = [float(np.linalg.norm(edge)) for plate in plates for edge in (plate.edge_u, plate.edge_v)]
            assert 0.02 <= min(sides) and max(sides) <= 0.3
            assert described.gap > 0.02 * min(sides)
            tilts.append(described.tilt_degrees)
    # Uniform over all rotations: half of the planes are tilted by more than 60 degrees.
    assert 0.4 < sum(tilt > 60 for tilt in tilts) / len(tilts) < 0.6


def test_parts_of_real_set_ups_add_up_and_are_known(found: list[Entry]) -> None:
    for entry in found:
        for quantity in PARTS:
            named = entry.parts(quantity)
            assert tuple(named) == PARTS[quantity] and set(EFFECTS) < set(named)
            assert math.fsum(named.values()) == pytest.approx(entry.error(quantity), abs=1e-12)
            assert 0 < entry.uncertainty(quantity) < 0.01
        for part in entry.split.effects.values():
            assert part.least <= part.value + 1e-27 and part.value <= part.greatest + 1e-27
        # The formula with every effect put right, without any constant: 22 % at worst over the published set-ups.
        assert abs(entry.parts(MUTUAL)["rest"]) < 0.4


def test_every_part_of_the_page_leads_somewhere(folder: Path) -> None:
    made = TOPIC.make(folder)
    assert "set-ups the model is" in made.headline
    pages = [made.path, *folder.glob("cases/*/case.html")]
    assert len(pages) == 1 + len({each.id for each in some()})
    for each in pages:
        for target in re.findall(r'(?:href|src)="([^"]*)"', each.read_text()):
            assert (each.parent / target).is_file(), f"{each}: {target}"
    case = next(folder.glob("cases/*/case.html")).read_text()
    assert "--method boundary-elements --rtol 0.0001" in case and "model − truth" in case
    assert TOPIC.make(folder).path.stat().st_mtime_ns == made.path.stat().st_mtime_ns


def test_a_report_beside_the_errors_shows_them_and_opens_their_cases(folder: Path) -> None:
    study = make_results(folder.parent / "study")
    TOPIC.make(folder)
    text = report_text(study)
    assert "Where does the model&#39;s error come from?" in text and ABSENT not in text
    assert "The error over gap and tilt" in text and 'data-cases="../../errors/cases"' in text
    for target in re.findall(r'href="(\.\./\.\./errors/[^"]*)"', text):
        assert (study / report.PAGES / target).is_file()
