"""No dead options: every option that a command's --help knows is demonstrated, by the test named here, to change what it says.

The test fails for an option that is not in the table, for one of the table that no help knows, and for a demonstration that is not
there or says nothing of its option.
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from analysis.__main__ import main
from tests.waiting import DEADLINE

ROOT = Path(__file__).resolve().parents[2]
MODEL, REFERENCE = "model/test_command_line.py", "fem_reference/test_command_line.py"
SWEEP = "model/test_sweep.py"
PAGE_OF_A_SWEEP = (
    "analysis/sweep/test_sweep_page.py",
    "test_the_command_makes_a_page_and_its_table_from_its_options",
)
FILM = ("analysis/show/test_show.py", "test_readings_along_the_motion_are_those_of_the_library")
LIVE = ("analysis/live/test_paths.py", "test_every_option_of_the_command_acts")
COVERAGE = (
    "analysis/coverage/test_coverage.py",
    "test_the_command_makes_page_table_and_file_from_its_options",
)
HONESTY = ("analysis/honesty/test_run.py", "test_every_option_of_the_command_acts")
GOLDEN = ("analysis/golden/test_run.py", "test_every_option_of_the_command_acts")
PERSON = ("geometries/scene/test_person.py", "test_the_command_writes_a_mesh_or_capsules")
HERE, IMPORT = "end_to_end/test_options.py", "end_to_end/test_import.py"
EXPORTED = ("end_to_end/test_export.py", "test_the_method_and_the_error_asked_for_are_the_users")
SAID = (HERE, "test_help_and_version_are_printed_and_nothing_else")
PASSED_ON = (HERE, "test_an_option_reaches_what_it_is_for")
# Command → option → the demonstration, a file of tests and a function.
OPTIONS: dict[tuple[str, ...], dict[str, tuple[str, str]]] = {
    ("fringe",): {"--help": SAID, "--version": SAID},
    ("fringe", "capacitance"): {
        "--help": SAID,
        "--version": SAID,
        "--json": (MODEL, "test_capacitance_as_json"),
        "--method": (MODEL, "test_method"),
        "--tolerance": (MODEL, "test_tolerance_is_kept_and_said"),
        "--output": ("model/test_output_file.py", "test_the_triangles_of_an_object_add_up_to_its_capacitance"),
        "--rtol": ("model/test_boundary_elements.py", "test_options_that_would_change_nothing_are_refused"),
        "--entries": ("model/test_boundary_elements.py", "test_the_module_answers_like_the_command"),
        "--derivatives": ("model/test_derivatives.py", "test_the_command_prints_them"),
        "--max-seconds": ("model/test_interruption.py", "test_after_the_limit_of_time_the_best_matrix_is_printed"),
        "--prepared": ("model/test_prepared.py", "test_the_command_finds_what_it_has_prepared"),
        "--frame": (SWEEP, "test_a_frame_that_is_none_is_refused"),
        "--motion": (SWEEP, "test_a_frame_that_is_none_is_refused"),
    },
    ("fringe", "sweep"): {
        "--help": SAID,
        "--version": SAID,
        "--motion": (SWEEP, "test_a_sweep_takes_the_options_of_the_method_and_a_motion"),
        "--method": (SWEEP, "test_every_frame_has_the_reading_of_the_scene_in_its_poses"),
        "--max-seconds": (SWEEP, "test_a_sweep_ends_after_its_time_with_the_frames_that_are_finished"),
        "--output": (SWEEP, "test_with_a_file_the_command_says_where_the_threshold_is_crossed"),
        "--rtol": (SWEEP, "test_status_3_says_that_a_frame_is_less_accurate_than_asked_for"),
        "--prepared": ("model/test_prepared.py", "test_a_sweep_gives_the_folder_to_the_methods_that_have_it"),
    },
    ("fringe", "collide"): {"--help": SAID, "--version": SAID, "--json": (HERE, "test_json_in_the_place_of_a_table")},
    ("fringe", "export"): {"--help": SAID, "--version": SAID, "--method": EXPORTED, "--rtol": EXPORTED},
    ("fringe", "info"): {"--help": SAID, "--version": SAID, "--json": (HERE, "test_json_in_the_place_of_a_table")},
    ("fringe", "import"): {
        "--help": SAID,
        "--version": SAID,
        "--geometry": (IMPORT, "test_visual_geometries_are_taken_when_asked_for"),
        "--missing": (
            "end_to_end/test_import_robots.py",
            "test_one_bad_mesh_is_told_and_stops_the_rest_only_if_it_shall",
        ),
        "--package-path": (IMPORT, "test_packages_are_found_by_a_path"),
        "--joints": ("end_to_end/test_import_joints.py", "test_joints_are_set_and_those_that_mimic_follow"),
        "--deflection": ("end_to_end/test_import_step.py", "test_deflection_is_for_step_and_greater_than_zero"),
    },
    ("fringe", "sense"): {
        "--help": SAID,
        "--version": SAID,
        "--json": (HERE, "test_json_in_the_place_of_a_table"),
        "--method": ("model/test_sense_command.py", "test_sense_as_json"),
    },
    ("fem_reference",): {
        "--help": SAID,
        "--version": SAID,
        "--json": (REFERENCE, "test_json_is_one_document_with_the_whole_answer"),
        "--error": (REFERENCE, "test_json_is_one_document_with_the_whole_answer"),
        "--rtol": (REFERENCE, "test_one_level_under_a_limit_still_encloses_the_truth"),
        "--max-seconds": (REFERENCE, "test_the_limit_of_time_ends_the_first_level_too"),
        "--max-unknowns": (REFERENCE, "test_one_level_under_a_limit_still_encloses_the_truth"),
        "--max-memory": (REFERENCE, "test_one_level_under_a_limit_still_encloses_the_truth"),
        "--only-readings": (REFERENCE, "test_only_readings_may_be_asked_for"),
        "--no-symmetry": (REFERENCE, "test_the_whole_of_space_is_meshed_when_symmetry_is_not_to_be_used"),
        "--geometry": ("bad_input/test_reference.py", "test_a_mesh_that_bounds_no_solid_unless_it_may_be_wrapped"),
        "--wrap-alpha": (REFERENCE, "test_lengths_of_a_wrap_are_positive"),
        "--wrap-offset": (REFERENCE, "test_lengths_of_a_wrap_are_positive"),
        "--columns": (REFERENCE, "test_columns_left_out_are_named_and_unknown_ones_refused"),
        "--output": (REFERENCE, "test_the_field_is_written_for_paraview"),
        "--slice": (REFERENCE, "test_a_slice_of_the_potential_runs_from_the_sensor_to_the_ground"),
    },
    ("geometries",): {"--help": SAID},
    ("geometries", "convert"): {"--help": SAID},
    ("geometries", "person"): {"--help": SAID, **dict.fromkeys(("--height", "--age", "--posture"), PERSON)},
    ("geometries", "expand"): {"--help": SAID},
    ("analysis",): {"--help": SAID},
    ("analysis", "run"): {
        "--help": SAID,
        "--results": PASSED_ON,
        "--jobs": PASSED_ON,
        "--measure-model": PASSED_ON,
        "--verify": PASSED_ON,
    },
    ("analysis", "nightly"): {
        "--help": SAID,
        "--results": PASSED_ON,
        "--jobs": PASSED_ON,
        "--job-seconds": PASSED_ON,
        "--profile": ("end_to_end/test_cluster.py", "test_a_study_solved_through_sbatch_has_the_table_of_a_local_run"),
        "--verify": PASSED_ON,
    },
    ("analysis", "job"): {"--help": SAID},
    ("analysis", "diff"): {
        "--help": SAID,
        "--output": ("analysis/topics/trends/test_trends.py", "test_drift_ends_with_code_1_a_table_and_a_document"),
    },
    ("analysis", "trends"): {
        "--help": SAID,
        "--bisect": ("analysis/topics/trends/test_trends.py", "test_the_command_bisects"),
        "--count": ("analysis/topics/trends/test_trends.py", "test_the_command_counts_before_it_tells"),
    },
    ("analysis", "report"): {"--help": SAID},
    ("analysis", "verify"): {"--help": SAID, "--output": PASSED_ON, "--jobs": PASSED_ON},
    ("analysis", "errors"): {"--help": SAID, "--output": PASSED_ON, "--jobs": PASSED_ON},
    ("analysis", "company"): {"--help": SAID, "--output": PASSED_ON, "--jobs": PASSED_ON},
    ("analysis", "machines"): {"--help": SAID, "--output": PASSED_ON, "--jobs": PASSED_ON},
    ("analysis", "insulators"): {"--help": SAID, "--output": PASSED_ON, "--jobs": PASSED_ON},
    ("analysis", "corrections"): {"--help": SAID, "--output": PASSED_ON},
    ("analysis", "documentation"): {"--help": SAID, "--output": PASSED_ON},
    ("analysis", "show"): {
        "--help": SAID,
        "--motion": FILM,
        "--output": ("analysis/show/test_show.py", "test_the_example_is_shown_by_its_name"),
        "--readings": FILM,
        "--between": FILM,
        "--rtol": FILM,
    },
    ("analysis", "live"): {
        "--help": SAID,
        "--motion": LIVE,
        "--rtol": LIVE,
        "--no-reference": LIVE,
        "--output": LIVE,
    },
    ("analysis", "sweep"): {
        "--help": SAID,
        "--motion": PAGE_OF_A_SWEEP,
        "--method": PAGE_OF_A_SWEEP,
        "--rtol": PAGE_OF_A_SWEEP,
        "--output": PAGE_OF_A_SWEEP,
    },
    ("analysis", "coverage"): {
        "--help": SAID,
        **dict.fromkeys(("--probe", "--reading", "--grid", "--potential", "--threshold", "--method", "--output"), COVERAGE),
    },
    ("analysis", "measure"): {"--help": SAID},
    ("analysis", "honesty"): {
        "--help": SAID,
        **dict.fromkeys(("--scenes", "--first", "--kinds", "--methods", "--field-solver", "--no-field-solver", "--seconds", "--only", "--results", "--jobs"), HONESTY),
    },
    ("analysis", "golden"): {"--help": SAID, **dict.fromkeys(("--against", "--only", "--times"), GOLDEN)},
}  # fmt: skip
SCENE = """
[[sensor]]
name = "front"
plates = [ { corner = [-0.05, -0.05, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] } ]
[[distance_sensor]]
name = "eye"
apex = [0, 0, 0]
direction = [0, 0, 1]
full_angle_degrees = 40
range = 0.8
[[object]]
name = "target"
shape = { type = "cube", size = 0.1 }
translation = [0, 0, 0.2]
"""


def run(*words: str | Path) -> subprocess.CompletedProcess[str]:
    start = (
        [str(ROOT / "build" / "bin" / "fringe")]
        if words[0] == "fringe"
        else [sys.executable, "-m", str(words[0])]
    )
    return subprocess.run(
        [*start, *map(str, words[1:])],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
        timeout=DEADLINE,
    )


def options_of(command: tuple[str, ...]) -> set[str]:
    """What its --help lists."""
    told = run(*command, "--help").stdout
    return set(re.findall(r"^\s+(?:-\w, ?)?(--[a-z][a-z-]*)", told, re.MULTILINE))


def commands_of(program: str) -> set[str]:
    """The subcommands that its --help lists."""
    told = run(program, "--help").stdout
    if program == "fringe":
        return set(re.findall(r"^  ([a-z]+)  ", told.split("Subcommands:")[1], re.MULTILINE))
    listed = re.search(r"^  \{([a-z,]+)\}", told, re.MULTILINE)
    return set(listed[1].split(",")) if listed else set()


@pytest.mark.parametrize("program", ["fringe", "fem_reference", "geometries", "analysis"])
def test_the_table_has_every_command(program: str) -> None:
    assert {command[1] for command in OPTIONS if command[0] == program and len(command) > 1} == commands_of(
        program
    )


@pytest.mark.parametrize("command", OPTIONS, ids=" ".join)
def test_the_table_has_every_option(command: tuple[str, ...]) -> None:
    assert set(OPTIONS[command]) == options_of(command)


@pytest.mark.parametrize("command", OPTIONS, ids=" ".join)
def test_every_option_has_a_demonstration(command: tuple[str, ...]) -> None:
    for option, (file, name) in OPTIONS[command].items():
        assert option in source_of(ROOT / "tests" / file, name), f"{file}::{name} says nothing of {option}"


def source_of(file: Path, name: str) -> str:
    """The text of a test with what it is parametrised by."""
    text = file.read_text(encoding="utf-8")
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef) and node.name == name:
            first = min([node.lineno, *(decorator.lineno for decorator in node.decorator_list)])
            return "\n".join(text.splitlines()[first - 1 : node.end_lineno])
    raise AssertionError(f"{file} has no test {name}")


@pytest.mark.parametrize("command", OPTIONS, ids=" ".join)
def test_help_and_version_are_printed_and_nothing_else(command: tuple[str, ...]) -> None:
    for option, sign in (("--help", "sage: "), ("--version", r"\d+\.\d+")):
        if option in OPTIONS[command]:
            done = run(*command, option)
            assert done.returncode == 0 and done.stderr == ""
            assert re.search(sign, done.stdout)


@pytest.mark.parametrize("command", ["collide", "info", "sense"])
def test_json_in_the_place_of_a_table(tmp_path: Path, command: str) -> None:
    (tmp_path / "scene.toml").write_text(SCENE)
    table = run("fringe", command, tmp_path / "scene.toml")
    document = run("fringe", command, tmp_path / "scene.toml", "--json")
    assert table.returncode == document.returncode == 0
    assert document.stdout.startswith("{") and not table.stdout.startswith("{")


class Reached(Exception):
    """What was called stands for what it would do."""


SET_UPS_RUN = "analysis.pipeline.set_up_stages.SetUpStages.run"
VERIFICATION_RUN = "analysis.topics.verification.stage.Rows.run"


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
        (["errors", "--output", "OUT"], SET_UPS_RUN, 1, "OUT"),
        (["errors", "--output", "OUT", "--jobs", "3"], SET_UPS_RUN, 3, 3),
        (["company", "--output", "OUT"], SET_UPS_RUN, 1, "OUT"),
        (["company", "--output", "OUT", "--jobs", "3"], SET_UPS_RUN, 3, 3),
        (["machines", "--output", "OUT"], SET_UPS_RUN, 1, "OUT"),
        (["machines", "--output", "OUT", "--jobs", "3"], SET_UPS_RUN, 3, 3),
        (["insulators", "--output", "OUT"], SET_UPS_RUN, 1, "OUT"),
        (["insulators", "--output", "OUT", "--jobs", "3"], SET_UPS_RUN, 3, 3),
        (["corrections", "--output", "OUT"], "analysis.topics.corrections.stage.Evaluated.run", 1, "OUT"),
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
