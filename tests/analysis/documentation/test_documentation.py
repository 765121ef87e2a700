"""The documentation: every example says what it shows, the site is made without a warning."""

from __future__ import annotations

import doctest
from pathlib import Path

import pytest

from analysis import documentation
from analysis.documentation import make
from analysis.pipeline.model_stage import model_module

ROOT = Path(__file__).resolve().parents[3]
PAGES = Path(documentation.__file__).parent


@pytest.mark.parametrize("page", sorted((PAGES / "algorithms").glob("*.md")), ids=lambda page: page.stem)
def test_an_algorithms_page_has_all_its_parts_and_its_example_holds(
    page: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = page.read_text(encoding="utf-8")
    for part in ("Formula", "Source", "Error", "Cost", "Example"):
        assert f"**{part}.**" in text
    monkeypatch.chdir(ROOT)
    model_module()
    assert doctest.testfile(str(page), module_relative=False).failed == 0


def test_the_scene_of_the_examples_is_the_readmes() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert (PAGES / "hand.toml").read_text(encoding="utf-8") in readme


@pytest.mark.night
def test_the_site_is_made_without_a_warning(tmp_path: Path) -> None:
    first = make.build(tmp_path / "site")
    pages = {path.stem for path in (first.parent / "algorithms").glob("*.html")}
    assert pages == {path.stem for path in (PAGES / "algorithms").glob("*.md")}
    assert "plate_integral" in (first.parent / "python.html").read_text(encoding="utf-8")
    assert any((first.parent / "cpp").glob("*boundary__elements*.html"))


def test_a_folder_of_something_else_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "letters").write_text("dear")
    with pytest.raises(make.DocumentationError, match="not a site"):
        make.build(tmp_path)
    assert (tmp_path / "letters").is_file()
