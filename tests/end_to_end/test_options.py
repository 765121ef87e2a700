"""No dead options: every option that a command's --help knows is used by a test of that command, --help and --version say what they should, and
former words are refused in one line that says what to write now."""

import re
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from analysis.__main__ import main
from analysis.pipeline.model_stage import model_module
from geometries.common.errors import InputError
from geometries.studies import study
from tests import scenes
from tests.analysis.synthetic import HEAD, PARALLEL
from tests.programs import ROOT, fringe_command, in_this_process

COMMANDS = {
    "fringe": ("capacitance", "collide", "export", "import", "info", "sense", "sweep"),
    "fem_reference": (),
    "geometries": ("convert", "expand", "person"),
    "analysis": (
        *("run", "nightly", "job", "report", "diff", "trends", "verify", "errors", "company", "machines"),
        *("insulators", "corrections", "documentation", "show", "live", "sweep", "coverage", "honesty"),
        *("golden", "measure"),
    ),
}
EACH = [(program, *command) for program, all_ in COMMANDS.items() for command in ((), *((c,) for c in all_))]
every_command = pytest.mark.parametrize("command", EACH, ids=" ".join)


@cache
def printed(*words: str) -> str:
    """What a command prints that ends well and says nothing else. Those of Python are called in this process, which is faster."""
    if words[0] == "fringe":
        done = fringe_command(*words[1:])
    else:
        done = in_this_process(import_module(f"{words[0]}.__main__").main, *words[1:])
    assert done.returncode == 0 and not done.stderr
    return done.stdout


def options_of(*command: str) -> set[str]:
    """The options that its --help lists."""
    return set(re.findall(r"^\s+(?:-\w, ?)?(--[a-z][a-z-]*)", printed(*command, "--help"), re.MULTILINE))


def commands_of(program: str) -> set[str]:
    """The subcommands that its --help lists."""
    told = printed(program, "--help")
    if program == "fringe":
        return set(re.findall(r"^  ([a-z]+)  ", told.split("Subcommands:")[1], re.MULTILINE))
    listed = re.search(r"^  \{([a-z,]+)\}", told, re.MULTILINE)
    return set(listed[1].split(",")) if listed else set()


@pytest.mark.parametrize("program", COMMANDS)
def test_these_are_all_commands(program: str) -> None:
    assert set(COMMANDS[program]) == commands_of(program)


TESTS = [file.read_text(encoding="utf-8") for file in (ROOT / "tests").rglob("test_*.py")]


@every_command
def test_a_test_that_uses_the_command_uses_each_option(command: tuple[str, ...]) -> None:
    def has(text: str, word: str) -> bool:
        return re.search(rf"(?<![\w-]){word}(?![\w-])", text) is not None

    using = [text for text in TESTS if has(text, command[-1])]
    for option in options_of(*command) - {"--help", "--version"}:
        assert any(has(text, option) for text in using), option


@every_command
def test_help_and_version_are_printed_and_nothing_else(command: tuple[str, ...]) -> None:
    for option, sign in (("--help", "sage: "), ("--version", r"\d+\.\d+")):
        if option in options_of(*command):
            assert re.search(sign, printed(*command, option))


class Reached(Exception):
    """What was called stands for what it would do."""


OF_SET_UPS = ("errors", "company", "machines", "insulators")
SET_UPS_RUN = "analysis.pipeline.set_up_stages.SetUpStages.run"
VERIFICATION_RUN = "analysis.topics.verification.topic.Rows.run"


@pytest.mark.parametrize(
    ("words", "function", "position", "expected"),
    [
        (["run", "smoke", "--results", "OUT"], "analysis.study.workflow.run", 1, "OUT"),
        (["run", "smoke", "--results", "OUT", "--jobs", "3"], "analysis.study.workflow.run", 2, 3),
        (["run", "smoke", "--results", "OUT"], "analysis.study.workflow.run", 2, None),
        (["run", "smoke", "--results", "OUT", "--measure-model"], "analysis.study.workflow.run", 3, True),
        (["run", "smoke", "--results", "OUT"], "analysis.study.workflow.run", 3, False),
        (["run", "smoke", "--results", "OUT", "--verify"], VERIFICATION_RUN, 3, None),
        (["nightly", "smoke", "--results", "OUT"], "analysis.nightly.night.run", 1, "OUT"),
        (["nightly", "smoke", "--results", "OUT", "--jobs", "3"], "analysis.nightly.night.run", 2, (None, 3, None)),
        (["nightly", "smoke", "--results", "OUT", "--job-seconds", "9"], "analysis.nightly.night.run", 2, (None, None, 9)),
        (["nightly", "smoke", "--results", "OUT", "--verify"], VERIFICATION_RUN, 3, None),
        (["verify", "--output", "OUT"], VERIFICATION_RUN, 1, "OUT"),
        (["verify", "--output", "OUT", "--jobs", "3"], VERIFICATION_RUN, 3, 3),
        *(([topic, "--output", "OUT"], SET_UPS_RUN, 1, "OUT") for topic in OF_SET_UPS),
        *(([topic, "--output", "OUT", "--jobs", "3"], SET_UPS_RUN, 3, 3) for topic in OF_SET_UPS),
        (["corrections", "--output", "OUT"], "analysis.topics.corrections.topic.Evaluated.run", 1, "OUT"),
        (["documentation", "--output", "OUT"], "analysis.documentation.make.build", 0, "OUT"),
    ],
)  # fmt: skip
def test_an_option_reaches_what_it_is_for(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    words: list[str],
    function: str,
    position: int,
    expected: Any,
) -> None:
    """What it changes there is shown by that function's own tests."""
    called: list[tuple[Any, ...]] = []

    def reached(*arguments: Any) -> None:
        called.append(arguments)
        raise Reached

    for before in ("analysis.study.workflow.run", "analysis.nightly.night.run"):
        if before != function:
            monkeypatch.setattr(
                before, lambda *_: type("Night", (), {"failures": []})() if "night." in before else []
            )
    monkeypatch.setattr(function, reached)
    folder = tmp_path / "out"
    with pytest.raises(Reached):
        main([str(folder) if word == "OUT" else word for word in words])
    found = called[0][position]
    if isinstance(expected, tuple):
        found = (found.profile, found.workers, found.job_seconds)
    assert found == (folder if expected == "OUT" else expected)


FORMER_SCENE = scenes.SENSOR + scenes.body("target", "plate", size=[0.1, 0.1], translation=[0, 0, 0.03])
FORMER_OPTIONS = [
    (("--correction", "none"), "write --method formula"),
    (("--correction", "formula"), "write --method formula"),
    (("--correction=recommended",), "--method auto"),
    (("--plates", "nearest"), "--method exact+nearest"),
    (("--faces=facing",), "--method exact+facing"),
    (("--only-readings",), "leave it out"),
]
KEYWORDS = [
    ({"correction": "formula"}, 'method="formula", or "auto"'),
    ({"plates": "nearest"}, "exact+nearest"),
    ({"faces": "facing"}, "exact+facing"),
    ({"method": "recommended"}, "write auto"),
    ({"method": "reduced:2"}, "write reduced with rtol"),
]
OF_STUDIES = [("recommended", "write auto"), ("reduced:3", "write reduced")]


@pytest.mark.parametrize(("words", "now"), FORMER_OPTIONS, ids=str)
def test_the_command_says_what_to_write(words: tuple[str, ...], now: str, tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(FORMER_SCENE)
    done = fringe_command("capacitance", tmp_path / "scene.toml", *words)
    assert (done.returncode, done.stdout) == (2, "")
    assert now in done.stderr and done.stderr.count("\n") == 1


@pytest.mark.parametrize(("keywords", "now"), KEYWORDS, ids=str)
def test_python_says_what_to_write(keywords: dict[str, str], now: str) -> None:
    with pytest.raises((TypeError, ValueError)) as refusal:
        model_module().Scene.loads(FORMER_SCENE).capacitance(**keywords)
    assert now in str(refusal.value)


@pytest.mark.parametrize(("method", "now"), OF_STUDIES)
def test_a_study_says_what_to_write(method: str, now: str) -> None:
    text = HEAD.replace('["exact", "split:0", "split:4"]', f'["exact", "{method}"]') + PARALLEL
    with pytest.raises(InputError, match=now) as refusal:
        study.loads(text)
    assert "model.methods" in str(refusal.value) and "\n" not in str(refusal.value)
