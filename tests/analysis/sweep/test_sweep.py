"""The page of a sweep: whose answer is the truth, where a change crosses its threshold, and what the command makes of its options."""

import csv
import json
import math
import re
from pathlib import Path
from typing import Any

import pytest

from analysis import __main__ as command_line
from analysis.sweep import make, series
from analysis.sweep.series import crossings
from geometries.scene import motion, reader
from tests import scenes
from tests.programs import analysis


HALFWAY = math.sqrt(1000)
"""Changes of 1, 10, 100 are exponential in the frame: this lies halfway between the second and the third."""
TWICE, MORE = math.log10(2), math.log10(1.5)
"""Where the ends of an error of half each value cross it, 0.5 and 1.5 times the change, beside that."""
CROSSINGS = {
    "a power law at its exact place": ([1, 10, 100], [0, 0, 0], HALFWAY, [(2.5, 2.5, 2.5, True)]),
    "an error as an interval": ([1, 10, 100], [0.5, 5, 50], HALFWAY, [(2.5, 2.5 - MORE, 2.5 + TWICE, True)]),
    "what falls": ([100, 10, 1], [50, 5, 0.5], HALFWAY, [(1.5, 1.5 - TWICE, 1.5 + MORE, False)]),
    "the sign does not count": ([-1, -100], [0, 0], 10, [(1.5, 1.5, 1.5, True)]),
    "a zero by itself": ([0, 4], [0, 0], 1, [(1.25, 1.25, 1.25, True)]),
    "not beside what is unknown": ([1, None, 4], [0, 0, 0], 2, []),
    "every time": ([1, 4, 1], [0, 0, 0], 2, [(1.5, 1.5, 1.5, True), (2.5, 2.5, 2.5, False)]),
}


@pytest.mark.parametrize(
    ("changes", "errors", "threshold", "expected"), CROSSINGS.values(), ids=list(CROSSINGS)
)
def test_a_change_crosses_its_threshold(
    changes: list[float | None],
    errors: list[float],
    threshold: float,
    expected: list[tuple[float, float, float, bool]],
) -> None:
    found = [tuple(vars(each).values()) for each in crossings(changes, errors, threshold)]
    assert found == [tuple(map(pytest.approx, each)) for each in expected]


def test_an_error_that_reaches_beyond_the_motion_leaves_an_end_open() -> None:
    assert crossings([8.0, 12.0], [3.0, 1.5], 10.0)[0].first is None
    assert crossings([8.0, 12.0], [1.0, 3.0], 10.0)[0].last is None


SCENE = (
    scenes.link("wrist")
    + scenes.SENSOR
    + scenes.body(
        "hand", "cuboid", size=[0.08, 0.1, 0.02], link="wrist", translation=[0, 0, 0.01], target=True
    )
    + scenes.body("table", "cuboid", size=[0.3, 0.3, 0.02], translation=[0, 0, -0.05])
    + scenes.table("reading", name="self <front>", sense="front", drive=["front"], threshold=100e-15)
)
HEADER = (
    "frame,name,reading,method,answered_by,value_F,value_error_F,background_F,background_error_F,change_F,change_error_F,"
    "delta_voltage_V,threshold_F,noticed,reached,key"
)
MOTION = "".join(
    f'[[frame]]\nname = "{100 * height:g} cm"\nposes = [ {{ link = "wrist", translation = [0, 0, {height}] }} ]\n'
    for height in (0.3, 0.1, 0.03)
)


def row(frame: int, method: str, change: float | None, error: float | None, noticed: str) -> str:
    """A row of the table, in fF; an answer without a change is that of a method that refused."""
    numbers = ["" if number is None else f"{number}e-15" for number in (change, error)]
    known = ["", "1e-13", noticed, "yes", "k"] if change is not None else [""] * 5
    return ",".join([str(frame), f"f{frame}", "self <front>", method, method, *[""] * 4, *numbers, *known])


def sweep_of(folder: Path, *rows: str) -> series.Sweep:
    table = folder / "table.csv"
    table.write_text("\n".join([HEADER, *rows]) + "\n")
    return series.read(table)


def frames_of(scene: Path) -> tuple[motion.Frame, ...]:
    return motion.load(scene.with_suffix(".motion.toml"), reader.load(scene))


def test_the_truth_is_the_answer_with_the_least_error_in_every_frame(tmp_path: Path) -> None:
    found = sweep_of(
        tmp_path,
        *(row(1, "exact", 90, None, "no"), row(1, "a", 50, 5, "no"), row(1, "b", 52, 1, "no")),
        *(row(2, "exact", 300, None, "yes"), row(2, "a", 200, 5, "yes"), row(2, "b", None, None, "")),
        *(row(3, "exact", 300, None, "yes"), row(3, "a", None, None, ""), row(3, "b", None, None, "")),
    )
    (only,) = found.series
    assert [said.answered_by for said in only.truth] == ["b", "a", ""]
    assert only.threshold == 1e-13 and found.frames == ("f1", "f2", "f3")


def test_the_place_of_a_crossing_is_told_with_the_pose_and_the_interval(tmp_path: Path, scene: Path) -> None:
    """10, 100, 1000 fF about a threshold of 100 √10 fF would cross at 2.5; of 100 fF they do at frame 2."""
    found = sweep_of(tmp_path, *(row(n, "a", 10.0**n / 2, 0.05 * 10**n, "no") for n in (1, 2, 3)))
    (sentence,) = make.findings(found, frames_of(scene))
    assert sentence.startswith(
        "self <front>, threshold 100 fF: noticed from frame 2.30 on, between f2 and f3"
    )
    assert "wrist at (0, 0, 0.07893) m (the error allows frame 2.26 to frame 2.35)" in sentence


@pytest.mark.parametrize(
    ("noticed", "error", "words"),
    [
        ("yes", 1, "noticed in every frame"),
        ("no", 1, "not noticed in any frame"),
        ("", None, "no method states an error"),
    ],
)
def test_a_threshold_that_is_not_crossed_has_words_too(
    tmp_path: Path, scene: Path, noticed: str, error: float | None, words: str
) -> None:
    size = 500.0 if noticed == "yes" else 5.0
    found = sweep_of(tmp_path, *(row(n, "a", size, error, noticed) for n in (1, 2, 3)))
    assert words in make.findings(found, frames_of(scene))[0]


def figures(text: str) -> list[list[dict[str, Any]]]:
    """The traces of every figure on a page."""
    decoder, found = json.JSONDecoder(), []
    for match in re.finditer(r'\[\{"(?:fill|hover|line|error|x|mode)', text):
        found.append(decoder.raw_decode(text, match.start())[0])
    return found


def test_the_command_makes_a_page_and_its_table_from_its_options(scene: Path) -> None:
    target, moved = scene.with_name("page.html"), scene.with_name("other.toml")
    moved.write_text(MOTION.replace("0.03", "0.05"))
    asked = ["--motion", moved, "--method", "exact,boundary-elements", "--rtol", "0.03", "--output", target]
    printed = analysis("sweep", scene, *asked).stdout
    assert "noticed from frame" in printed and f"page: {target}" in printed
    with target.with_suffix(".csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [each["method"] for each in rows] == 3 * ["exact", "boundary-elements"]
    text = target.read_text()
    assert 'href="page.csv"' in text and "--rtol 0.03" in text and "self <front>" not in text
    assert (target.parent / "report" / "plotly.js").is_file() and len(text) < 1_000_000
    names = [trace["name"] for traces in figures(text) for trace in traces]
    assert {"exact", "boundary-elements", "threshold 100 fF", "crossed here"} <= set(names)
    assert "error of the best truth at hand" in names
    drawn = next(
        trace for traces in figures(text) for trace in traces if trace["name"] == "boundary-elements"
    )
    of_method = [1e15 * float(each["change_F"]) for each in rows if each["method"] == "boundary-elements"]
    assert drawn["y"] == pytest.approx(of_method)


@pytest.mark.parametrize("options", [["--method", "exact,bem"], ["--motion", "none.toml"], ["--rtol", "-1"]])
def test_wrong_input_ends_with_status_2_and_no_page(
    scene: Path, options: list[str], capfd: pytest.CaptureFixture[str]
) -> None:
    target = scene.with_name("page.html")
    assert command_line.main(["sweep", str(scene), *options, "--output", str(target)]) == 2
    assert capfd.readouterr().err and not target.exists()


def test_the_page_of_a_scene_elsewhere_is_in_the_current_folder(
    scene: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(scene.parent)
    analysis("sweep", scene, "--method", "exact")
    assert (scene.parent / "results" / "sweep" / f"{scene.stem}.html").is_file()


def test_a_scene_without_a_motion_is_refused(scene: Path) -> None:
    scene.with_suffix(".motion.toml").unlink()
    told = analysis("sweep", scene, status=2).stderr
    assert "has no motion beside it: name one by --motion" in told
