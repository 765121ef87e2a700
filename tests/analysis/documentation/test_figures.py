"""The figures of the notes are those that their script draws, and every note shows the ones beside it."""

from __future__ import annotations

import subprocess
from pathlib import Path

from analysis.documentation import figures

ROOT = Path(__file__).resolve().parents[3]


def test_the_figures_are_those_that_the_script_draws(tmp_path: Path) -> None:
    for path in figures.draw(tmp_path):
        name = path.relative_to(tmp_path)
        assert (ROOT / name).read_text(encoding="utf-8") == path.read_text(encoding="utf-8"), name


def test_every_figure_is_shown_and_small() -> None:
    listed = subprocess.run(["git", "ls-files", "*.md"], cwd=ROOT, capture_output=True, text=True, check=True)
    notes = "".join((ROOT / note).read_text(encoding="utf-8") for note in listed.stdout.split())
    for name in figures.FIGURES:
        assert f"figures/{Path(name).name})" in notes
        assert (ROOT / name).stat().st_size < 50_000
