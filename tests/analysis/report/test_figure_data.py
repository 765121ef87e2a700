"""The numbers of a figure beside its page: a line for each point, and only the columns that have any number."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import plotly.graph_objects as go
import pytest

from analysis.report import page
from analysis.report.plot import Panel, axis, figure, guide, joined, log_axis

BODY = go.Mesh3d(x=[0, 1, 0], y=[0, 0, 1], z=[0, 0, 0])


def lines(figure_: go.Figure, folder: Path) -> list[list[str]]:
    """The data of a figure that a page shows."""
    shown = page.figures([Panel("The model's error, in % of all that there is here", figure_)])
    page.write(folder / "errors.html", page.document("Errors", "", [shown], ""))
    (target,) = re.findall(r'href="(.*?)" download>CSV', (folder / "errors.html").read_text())
    assert target == "data/errors/1_the_model_s_error_in_of.csv"
    return list(csv.reader((folder / target).read_text(encoding="utf-8").splitlines()))


def test_points_have_their_series_their_errors_and_their_case(tmp_path: Path) -> None:
    cases, notes = ["0123456789abcdef", "a"], ["first<br>of two", ""]
    trace = joined("a", [1, 2], [3.5, 4.5], "red", "%{y}", [0.1, 0.2], customdata=cases, text=notes)
    found = lines(figure([trace, guide("limit", [1, 2], [4, 4])], log_axis("gap (cm)"), axis("")), tmp_path)
    assert found == [
        ["series", "gap (cm)", "y", "error", "note", "set-up"],
        ["a", "1", "3.5", "0.1", "first; of two", "0123456789abcdef"],
        ["a", "2", "4.5", "0.2", "", "a"],
        ["limit", "1", "4", "", "", ""],
        ["limit", "2", "4", "", "", ""],
    ]


def test_a_map_has_a_line_for_each_cell(tmp_path: Path) -> None:
    trace = go.Heatmap(x=["1", "2"], y=["a"], z=[[5, None]], text=[["one", ""]], customdata=[["id", ""]])
    found = lines(figure([trace], axis("size"), axis("gap")), tmp_path)
    assert found == [
        ["series", "size", "gap", "value", "note", "set-up"],
        ["", "1", "a", "5", "one", "id"],
        ["", "2", "a", "", "", ""],
    ]


@pytest.mark.parametrize(("shown", "with_data"), [(go.Figure(BODY), True), (go.Figure(go.Scatter()), False)])
def test_bodies_in_space_and_pictures_of_cases_have_none(
    shown: go.Figure, with_data: bool, tmp_path: Path
) -> None:
    text = page.figures([Panel("drawn", shown)], with_data=with_data)
    page.write(tmp_path / "page.html", text)
    assert "CSV" not in text and [path.name for path in tmp_path.iterdir()] == ["page.html"]


def test_data_of_figures_that_are_gone_go(tmp_path: Path) -> None:
    trace = joined("a", [1], [2], "red", "")
    lines(figure([trace], axis("x"), axis("y")), tmp_path)
    page.write(tmp_path / "errors.html", "no figure")
    assert not (tmp_path / "data" / "errors").exists()
