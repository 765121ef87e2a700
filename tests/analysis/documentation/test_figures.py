"""Every figure of the notes is shown by one of them, and small."""

from __future__ import annotations

import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]


def test_every_figure_is_shown_and_small() -> None:
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True)
    files = [ROOT / name for name in listed.stdout.split()]
    notes = "".join(note.read_text(encoding="utf-8") for note in files if note.suffix == ".md")
    figures = [file for file in files if file.suffix == ".svg" and file.parent.name == "figures"]
    assert figures
    for figure in figures:
        assert f"figures/{figure.name})" in notes
        assert figure.stat().st_size < 50_000
