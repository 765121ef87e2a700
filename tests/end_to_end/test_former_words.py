"""Words of before the methods had one name each are refused, in one line that says what to write now."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from analysis.pipeline.model_stage import model_module
from geometries.common.errors import InputError
from geometries.studies import study
from tests.analysis.synthetic import HEAD, PARALLEL
from tests.waiting import DEADLINE

FRINGE = Path(__file__).resolve().parents[2] / "build/bin/fringe"
SCENE = """
[[sensor]]
name = "front"
plates = [ { corner = [-0.05, -0.05, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] } ]
[[object]]
name = "target"
shape = { type = "plate", size = [0.1, 0.1] }
translation = [0, 0, 0.03]
"""
COMMANDS = [
    (("--correction", "none"), "write --method formula"),
    (("--correction", "formula"), "write --method formula"),
    (("--correction=recommended",), "--method auto"),
    (("--plates", "nearest"), "--method exact+nearest"),
    (("--faces=facing",), "--method exact+facing"),
    (("--only-readings",), "leave it out"),
    (("--method", "recommended"), "write auto"),
    (("--method", "reduced:2"), "write reduced with rtol"),
]
KEYWORDS = [
    ({"correction": "formula"}, 'method="formula", or "auto"'),
    ({"plates": "nearest"}, "exact+nearest"),
    ({"faces": "facing"}, "exact+facing"),
    ({"method": "recommended"}, "write auto"),
    ({"method": "reduced:2"}, "write reduced with rtol"),
]
OF_STUDIES = [("recommended", "write auto"), ("reduced:3", "write reduced")]


@pytest.mark.parametrize(("words", "now"), COMMANDS, ids=str)
def test_the_command_says_what_to_write(words: tuple[str, ...], now: str, tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(SCENE)
    asked = [FRINGE, "capacitance", tmp_path / "scene.toml", *words]
    done = subprocess.run(asked, capture_output=True, text=True, check=False, timeout=DEADLINE)
    assert (done.returncode, done.stdout) == (2, "")
    assert now in done.stderr and done.stderr.count("\n") == 1


@pytest.mark.parametrize(("keywords", "now"), KEYWORDS, ids=str)
def test_python_says_what_to_write(keywords: dict[str, str], now: str) -> None:
    with pytest.raises((TypeError, ValueError)) as refusal:
        model_module().Scene.loads(SCENE).capacitance(**keywords)
    assert now in str(refusal.value)


@pytest.mark.parametrize(("method", "now"), OF_STUDIES)
def test_a_study_says_what_to_write(method: str, now: str) -> None:
    text = HEAD.replace('["exact", "split:0", "split:4"]', f'["exact", "{method}"]') + PARALLEL
    with pytest.raises(InputError, match=now) as refusal:
        study.loads(text)
    assert "model.methods" in str(refusal.value) and "\n" not in str(refusal.value)
