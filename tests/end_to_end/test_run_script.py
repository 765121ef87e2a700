"""./run works wherever the user stands."""

from __future__ import annotations

import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_a_folder_named_like_ours_where_the_user_stands_is_not_taken_for_ours(tmp_path: Path) -> None:
    for name in ("analysis", "geometries"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text("raise SystemExit('the wrong package')")
    done = subprocess.run(
        [ROOT / "run", "no such study"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 2, done.stderr
    assert "no such study" in done.stderr and "wrong package" not in done.stderr
