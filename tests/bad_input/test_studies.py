"""Studies, motions and folders of results that cannot be used: one line, status 2, and nothing is written."""

import os
from pathlib import Path

import pytest

from tests import scenes
from tests.bad_input.case import SCENE, SENSOR, body
from tests.programs import analysis
from tests.scenes import HEAD

SWEEP = scenes.sweep("parallel", gap=0.05)
WHOLE = HEAD + SWEEP
# The faulty text of a study, and what the message has to name. tests/geometries tries the keys of studies and motions.
STUDIES = {
    "prose": ("this is a letter\n", ""),
    "NUL": (WHOLE + "\0", ""),
    "a name with NUL": (WHOLE.replace('"synthetic"', '"b\\u0000d"'), "name"),
    "a name longer than any": (WHOLE.replace('"synthetic"', f'"{"b" * 300}"'), "name"),
    "time without end": (WHOLE.replace("60", "inf"), "max_seconds"),
    "sizes of no length": (WHOLE.replace("sensor_size = [0.1, 0.1]", "sensor_size = []"), "sensor_size"),
    "a range of a thousand million": (WHOLE.replace("0.05", "{ linspace = [0.1, 0.2, 1000000000] }"), "linspace"),
    "ranges whose product is too large": (
        WHOLE.replace("0.05", "{ linspace = [0.1, 0.2, 10000] }")
        + "offset = ["
        + ", ".join(f"[{k}, 0]" for k in range(200))
        + "]\n",
        "sweep",
    ),
}  # fmt: skip
FRAME = '[[frame]]\nposes = [ { link = "arm", translation = [0, 0, 0.4] } ]\n'
MOTIONS = {
    "prose": ("this is a letter\n", ""),
    "a translation that is not finite": (FRAME.replace("0.4", "nan"), "translation"),
}


def _told_by(*arguments: str | Path) -> str:
    """What the command says while it refuses."""
    done = analysis(*arguments, status=2)
    assert done.stdout == "" and done.stderr.startswith("analysis: ") and done.stderr.endswith("\n")
    assert done.stderr[:-1].isprintable()
    return done.stderr


@pytest.mark.parametrize("wrong", STUDIES)
def test_a_study_that_cannot_be_run(tmp_path: Path, wrong: str) -> None:
    path = tmp_path / "a study.toml"
    text, place = STUDIES[wrong]
    path.write_text(text, newline="")
    told = _told_by("run", path, "--results", tmp_path / "results")
    assert str(path) in told and place in told.split(str(path), 1)[1]
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("wrong", ["missing", "a folder", "a pipe", "a link to itself", "too long"])
@pytest.mark.parametrize("command", ["run", "nightly", "show"])
def test_a_path_that_leads_to_no_file(tmp_path: Path, command: str, wrong: str) -> None:
    path = tmp_path / "study.toml"
    if wrong == "a folder":
        path.mkdir()
    elif wrong == "a pipe":
        os.mkfifo(path)
    elif wrong == "a link to itself":
        path.symlink_to(path)
    elif wrong == "too long":
        path = tmp_path / f"{'x' * 5000}.toml"
    before = list(tmp_path.iterdir())
    option = "--output" if command == "show" else "--results"
    assert str(path)[:200] in _told_by(command, path, option, tmp_path / "results")
    assert list(tmp_path.iterdir()) == before


@pytest.mark.parametrize("wrong", MOTIONS)
def test_a_motion_that_cannot_be_shown(tmp_path: Path, wrong: str) -> None:
    scene, path, page = (tmp_path / name for name in (SCENE, "motion.toml", "page.html"))
    scene.write_text('[[link]]\nname = "arm"\n' + SENSOR + body())
    text, place = MOTIONS[wrong]
    path.write_text(text)
    told = _told_by("show", scene, "--motion", path, "--output", page)
    assert str(path) in told and place in told and not page.exists()


@pytest.mark.parametrize("command", ["show", "live", "sweep", "coverage"])
def test_a_page_that_cannot_be_written_is_told_before_its_scene_is_read(tmp_path: Path, command: str) -> None:
    (tmp_path / "file").write_text("")
    none = tmp_path / "none.toml"
    given = [command, none, *(["--motion", none] if command == "sweep" else [])]
    for place in (tmp_path, tmp_path / "file" / "page.html"):
        assert f"{place}: is a folder" in _told_by(*given, "--output", place)


@pytest.mark.parametrize("command", ["report", "diff"])
def test_results_that_are_none(tmp_path: Path, command: str) -> None:
    for folder in (tmp_path / "missing", tmp_path):
        folders = [folder] * (2 if command == "diff" else 1)
        assert str(folder) in _told_by(command, *folders)
    assert list(tmp_path.iterdir()) == []
