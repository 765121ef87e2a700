"""A topic follows from its declaration: the example of CONTRIBUTING.md is one, and the command line has every topic of the project."""

import math
import re
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from analysis import __main__ as command_line, commands
from analysis.report.page import figures_of
from analysis.results.statistics import range_of, ratio, spread
from analysis.study.report import QUESTIONS
from analysis.topics.all import TOPICS
from analysis.topics.company.topic import COMPANY
from analysis.topics.errors.topic import ERRORS
from analysis.topics.insulators.topic import INSULATORS
from analysis.topics.machines.topic import MACHINES
from analysis.topics.published.topic import PUBLISHED
from analysis.topics.topic import Topic
from geometries.common.installation import ROOT
from tests.analysis.synthetic import make_results, report_text
from tests.analysis.topics.company import test_company
from tests.analysis.topics.errors import test_errors
from tests.analysis.topics.insulators import test_insulators
from tests.analysis.topics.machines import test_machines
from tests.programs import analysis


def test_errors_are_about_the_true_number_and_the_range_is_of_the_numbers() -> None:
    found = spread([0.8, 1.1, 1.6, math.nan, math.inf], true=1.0)
    assert found is not None and found.count == 3
    assert (found.median, found.least, found.greatest) == (1.1, 0.8, 1.6)
    assert found.worst == pytest.approx(0.6)
    assert found.rms == pytest.approx(math.sqrt((0.04 + 0.01 + 0.36) / 3))
    assert range_of(found) == found.range == "1.1 (0.8 to 1.6)"


def test_the_worst_keeps_its_sign() -> None:
    found = spread([-3.0, 2.0])
    assert found is not None and found.worst == -3 and found.least == -3 and found.greatest == 2


def test_there_is_none_without_numbers() -> None:
    assert spread([]) is None and spread([math.nan]) is None and range_of(None) == ""


def test_large_ratios_keep_all_their_digits() -> None:
    assert [ratio(value) for value in (0.12345, 63.84, -5735.2)] == ["0.123", "63.8", "-5735"]


MOST_LINES = 150


@pytest.fixture(scope="module")
def example() -> Topic[Any, Any]:
    """The topic that CONTRIBUTING.md declares."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    (declared,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert len(declared.splitlines()) <= MOST_LINES
    module = ModuleType("distance")
    # Data classes look for their module there.
    sys.modules[module.__name__] = module
    exec(compile(declared, "CONTRIBUTING.md", "exec"), module.__dict__)
    topic: Topic[Any, Any] = module.__dict__["DISTANCE"]
    return topic


def test_command_and_page_follow_from_the_example(
    example: Topic[Any, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(command_line.TOPICS, example.name, "example")
    monkeypatch.setitem(commands._COMMANDS, example.name, lambda options: commands._topic(example, options))
    assert example.make(tmp_path / "nothing").headline == example.absent
    for _ in range(2):
        assert "The change falls from" in analysis("distance", "--output", tmp_path).stdout
    changes = [each["change"] for each in example.found(example.load(tmp_path))]
    assert len(changes) == 3 and changes == sorted(changes, reverse=True) and changes[-1] > 0
    text = (tmp_path / example.file).read_text(encoding="utf-8")
    assert text.count("<tr>") == 4 and example.title in text
    assert "--rtol 0.01" in text and "python3 -m analysis distance --output" in text
    assert "measure" not in text, "it has neither stored truths nor a field check"
    assert len(list(tmp_path.glob("cases/*/scene.toml"))) == 3


def test_the_command_line_and_the_reports_have_every_topic() -> None:
    assert [*command_line.TOPICS] == [topic.verb for topic in TOPICS if topic is not PUBLISHED]
    asked = {topic.question for topic in TOPICS if topic.question}
    assert len(asked) == len(TOPICS) - 1 and asked <= {question.title for question in QUESTIONS}


@pytest.mark.parametrize(
    ("topic", "note"),
    [
        (ERRORS, "errors/ERRORS.md"),
        (COMPANY, "experiments/EXPERIMENTS.md"),
        (MACHINES, "machines/MACHINES.md"),
    ],
)
def test_notes_tell_how_many_set_ups_there_are(topic: Topic[Any, Any], note: str) -> None:
    count = len({each.id for each in topic.set_ups()})
    for document in ("analysis/GUIDE.md", f"analysis/topics/{note}"):
        assert f"{count} set-ups" in (ROOT / document).read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "topic", [topic for topic in TOPICS if topic is not PUBLISHED], ids=lambda topic: topic.name
)
def test_without_answers_a_page_says_how_to_get_them(topic: Topic[Any, Any], tmp_path: Path) -> None:
    made = topic.make(tmp_path)
    text = made.path.read_text(encoding="utf-8")
    assert made.headline == topic.absent and f"analysis {topic.verb}" in topic.absent
    assert topic.absent in text and not figures_of(text)
    (script,) = re.findall(r'src="(.*?)"', text)
    assert (tmp_path / script).is_file()


@pytest.mark.parametrize(
    ("topic", "some"),
    [
        (ERRORS, test_errors.some()),
        (COMPANY, test_company.some()),
        (MACHINES, test_machines.some()),
        (INSULATORS, test_insulators.some()),
    ],
    ids=["errors", "company", "machines", "insulators"],
)
def test_the_command_computes_what_is_missing_and_page_and_report_show_it(
    topic: Topic[Any, Any], some: tuple[Any, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(f"analysis.topics.{topic.name}.set_ups.all_set_ups", lambda: some)
    folder = tmp_path / topic.name
    made = []
    for _ in range(2):
        done = analysis(topic.verb, "--output", folder)
        assert f"report: {folder / topic.file}" in done.stdout and topic.absent not in done.stdout
        made.append((folder / topic.file).stat().st_mtime_ns)
    assert made[0] == made[1] and not done.stderr, "nothing was left to do"
    text = (folder / topic.file).read_text(encoding="utf-8")
    # The page on errors leads to its set-ups by maps and worst cases, and each has its command on a page of its own.
    is_whole = topic is not ERRORS
    assert f"analysis {topic.verb}" in text or not is_whole
    in_report = report_text(make_results(tmp_path / "study"))
    for page in (text, in_report):
        shown = [each.id in page for each in some]
        assert topic.absent not in page and (all(shown) if is_whole else any(shown))
