"""Which set-ups are taken apart, and what the pages say of them."""

from __future__ import annotations

import math
import re
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from analysis.results.set_up import describe, rectangles
from analysis.results.table import MUTUAL
from analysis.study import report
from analysis.topics.errors import records, section, set_ups
from analysis.topics.errors.parts import PARTS
from analysis.topics.errors.set_ups import MAPS, STAGES, SetUp, all_set_ups
from analysis.topics.errors.topic import ERRORS
from geometries.common.installation import ROOT
from tests.analysis.synthetic import make_results, report_text


def some() -> tuple[SetUp, ...]:
    """One in the middle of every map and its farthest, one of each family of the default study, a random one."""
    found = []
    for group in MAPS:
        members = sorted((each for each in all_set_ups() if each.group == group), key=lambda s: s.place or ())
        found += [members[len(members) // 2], members[-1]]
    own = [each for each in all_set_ups() if each.group == set_ups.DEFAULT]
    found += {each.family: each for each in own}.values()
    return (*found, next(each for each in all_set_ups() if each.group == set_ups.RANDOM))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("results") / STAGES.name
    assert STAGES.run(place, some(), 2) == []
    return place


def test_there_are_hundreds_of_all_families_and_in_random_poses() -> None:
    everything = all_set_ups()
    count = len({each.id for each in everything})
    assert count >= 300
    for document in ("analysis/GUIDE.md", "analysis/topics/errors/ERRORS.md"):
        assert f"{count} set-ups" in (ROOT / document).read_text()
    families = Counter(each.family for each in everything)
    assert set(families) == {"parallel", "inclined", "edge", "corner", "straddle", "random"}
    assert families["random"] >= 100 and all_set_ups() is everything


def test_every_map_has_a_set_up_at_each_of_its_points() -> None:
    for group in MAPS:
        places = {each.place for each in all_set_ups() if each.group == group}
        gaps, across = ({place[axis] for place in places if place} for axis in (0, 1))
        assert len(places) == len(gaps) * len(across) >= 49


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


def test_parts_of_real_set_ups_add_up_and_are_known(folder: Path) -> None:
    answers = STAGES.load(folder, some())
    entries = [records.entry(each, answers[each.id]) for each in some()]
    assert len(entries) == len(some())
    for entry in entries:
        for quantity in PARTS:
            parts = entry.parts(quantity)
            assert math.fsum(parts.values()) == pytest.approx(entry.error(quantity), abs=1e-12)
            assert 0 < entry.uncertainty(quantity) < 0.01
        # The formula with every effect put right, without any constant: 22 % at worst over the published set-ups.
        assert abs(entry.parts(MUTUAL)["rest"]) < 0.4


def test_every_part_of_the_page_leads_somewhere(folder: Path) -> None:
    made = ERRORS.make(folder)
    assert "set-ups the model is" in made.headline
    pages = [made.path, *folder.glob("cases/*/case.html")]
    assert len(pages) == 1 + len({each.id for each in some()})
    for each in pages:
        for target in re.findall(r'(?:href|src)="([^"]*)"', each.read_text()):
            assert (each.parent / target).is_file(), f"{each}: {target}"
    case = next(folder.glob("cases/*/case.html")).read_text()
    assert "--method boundary-elements --rtol 0.0001" in case and "model − truth" in case
    assert ERRORS.make(folder).path.stat().st_mtime_ns == made.path.stat().st_mtime_ns


def test_a_report_beside_the_errors_shows_them_and_opens_their_cases(folder: Path, tmp_path: Path) -> None:
    study = make_results(folder.parent / "study")
    ERRORS.make(folder)
    text = report_text(study)
    assert "Where does the model&#39;s error come from?" in text and section.ABSENT not in text
    assert "The error over gap and tilt" in text and 'data-cases="../../errors/cases"' in text
    for target in re.findall(r'href="(\.\./\.\./errors/[^"]*)"', text):
        assert (study / report.PAGES / target).is_file()
    assert section.ABSENT in report_text(make_results(tmp_path / "elsewhere" / "study"))
