"""The list of everything that was made: pages by their titles, tables by their names, and nothing of what they are made from."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from analysis import commands
from analysis.report import page, results_page
from analysis.results.store import write_text


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, title in (("default/report", "A < B"), ("default/trends", "Trends"), ("sweep/arm", "Arm")):
        write_text(tmp_path / f"{name}.html", page.document(title, "inputs", [], ""))
    for other in ("default/table.csv", "default/study.json", "default/cases/1/case.html", "coverage/arm.vtu"):
        write_text(tmp_path / other, "")
    write_text(
        tmp_path / "documentation" / "analysis" / "documentation" / "index.html", "<title>Notes</title>"
    )
    return tmp_path


def test_each_page_and_table_is_listed_once(folder: Path) -> None:
    made = results_page.make(folder)
    assert made == folder / "index.html"
    listed = re.findall(r'<a href="(.*?)">(.*?)</a>', made.read_text(encoding="utf-8"))
    assert listed == [
        ("coverage/arm.vtu", "arm.vtu"),
        ("default/report.html", "A &lt; B"),
        ("default/trends.html", "Trends"),
        ("default/table.csv", "table.csv"),
        ("documentation/analysis/documentation/index.html", "Notes"),
        ("sweep/arm.html", "Arm"),
    ]
    assert all((folder / target).is_file() for target, _ in listed)


def test_it_is_written_again_when_something_was_made(folder: Path) -> None:
    made = results_page.make(folder)
    assert made is not None
    before = made.stat().st_mtime_ns
    assert results_page.make(folder) == made and made.stat().st_mtime_ns == before
    write_text(folder / "live" / "head.html", "no title")
    results_page.make(folder)
    assert 'href="live/head.html">head.html' in made.read_text(encoding="utf-8")


def test_there_is_none_where_nothing_was_made(tmp_path: Path) -> None:
    assert results_page.make(tmp_path) is None and results_page.make(tmp_path / "nowhere") is None
    assert not list(tmp_path.iterdir())


def test_a_command_brings_it_up_to_date(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(commands.installation, "results_folder", lambda: folder)
    monkeypatch.setitem(commands._COMMANDS, "show", lambda _: 3)
    assert commands.run_command(type("Options", (), {"command": "show"})()) == 3  # type: ignore[arg-type]
    assert (folder / "index.html").is_file()
