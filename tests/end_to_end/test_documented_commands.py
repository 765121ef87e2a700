"""Every command that README and notes give is run: small here, or by the test that is named.

The test fails for a command that is not in the table and for one of the table that nothing gives. Commands are run by night.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

from analysis.measure import MEASURES
from tests.waiting import DEADLINE

ROOT = Path(__file__).resolve().parents[2]
HAND = "analysis/documentation/hand.toml"
README, INSTALL = "end_to_end/test_readme.py", "packaging/test_install.py"
OPTIONS, IMPORT, RUN = (
    "end_to_end/test_options.py",
    "end_to_end/test_import.py",
    "end_to_end/test_run_script.py",
)
RUN_SCRIPT = "end_to_end/test_run_script.py"
GOOGLE = "--benchmark_min_time=0 --benchmark_filter="
# Command → how it is run here, in the place of what takes longer; {out} is an empty folder.
SMALL = {
    "build/bin/collision_benchmark": "build/bin/collision_benchmark 1",
    "build/bin/collision_stress": "build/bin/collision_stress --count 300",
    "build/bin/correction_benchmark": f"build/bin/correction_benchmark {GOOGLE}plate",
    "build/bin/distance_sensor_benchmark": f"build/bin/distance_sensor_benchmark {GOOGLE}one_triangle",
    "build/bin/plate_integral_benchmark": f"build/bin/plate_integral_benchmark {GOOGLE}exact",
    "build/bin/plate_integral_stress": "build/bin/plate_integral_stress --count 300",
    "build/bin/scene_collision_benchmark": "build/bin/scene_collision_benchmark 1",
    "build/bin/scene_evaluator_benchmark": f"build/bin/scene_evaluator_benchmark {GOOGLE}bodies:25/tolerance:0.01",
    "build/bin/surface_tree_benchmark": f"build/bin/surface_tree_benchmark {GOOGLE}build/100$",
    "fringe capacitance --method METHOD": f"build/bin/fringe capacitance --method formula {HAND}",
    "fringe capacitance SCENE --derivatives": f"build/bin/fringe capacitance {HAND} --derivatives",
    "fringe collide SCENE": f"build/bin/fringe collide {HAND}",
    "python3 -m analysis show x_ray_arm": "python3 -m analysis show x_ray_arm --output {out}/show.html",
    "python3 -m analysis sweep guarded_sensor": "python3 -m analysis sweep guarded_sensor --rtol 0.1 --output {out}/sweep.html",
    "python3 -m analysis coverage guarded_sensor": "python3 -m analysis coverage guarded_sensor --probe sphere:0.02 --grid 0.06 --method none --output {out}/coverage.html",
    "python3 -m analysis honesty": "python3 -m analysis honesty --only 0 --methods reduced:1e-2 --results {out}/honesty",
    "python3 -m analysis golden FILE": "python3 -m analysis golden {out}/golden.json --only 'corrections/parallel-000/reduced*'",
    "python3 -m geometries person OUT": "python3 -m geometries person {out}/person.obj",
    "python3 -m geometries convert IN OUT": "python3 -m geometries convert {out}/in.vtu {out}/out.stl",
    "python3 -m tests.bad_input.corpus FOLDER": "python3 -m tests.bad_input.corpus {out}/corpus",
    "python3 -m tests.model.random_boundary_elements --count 120 --seed 1": "python3 -m tests.model.random_boundary_elements --count 2",
    "python3 -m tests.model.random_boundary_elements --meshes --count 25 --seed 1": "python3 -m tests.model.random_boundary_elements --meshes --count 1",
    "python3 -m tests.model.random_boundary_elements --sizes --count 60 --seed 2": "python3 -m tests.model.random_boundary_elements --sizes --count 1",
    "python3 -m tests.fuzz.random_answers SECONDS": "python3 -m tests.fuzz.random_answers --only 3",
    "python3 -m tests.model.random_soups": "python3 -m tests.model.random_soups --count 2",
    "sha256sum reference_table.csv": "sha256sum analysis/topics/published/reference_table.csv",
}  # fmt: skip
# Command → a file of tests, one of them, and what of the command this file must hold.
ELSEWHERE = {
    "(cd build && cpack)": ("packaging/test_debian_package.py", "test_it_says_what_it_is", "cpack"),
    "./run STUDY": (RUN, "test_what_it_asks_of_the_analysis", "./run"),
    "./run": (RUN, "test_what_it_asks_of_the_analysis", "./run"),
    "cmake --preset browser": (RUN, "test_what_it_asks_of_the_analysis", "cmake --preset browser"),
    "./run smoke": (RUN, "test_what_it_asks_of_the_analysis", "./run"),
    "python3 -m analysis run FILE": ("analysis/study/test_run.py", "test_a_study_is_solved_reported_and_told", "run"),
    "./run experiment_1": (RUN, "test_what_it_asks_of_the_analysis", "experiment_1"),
    "./run nightly": (RUN, "test_what_it_asks_of_the_analysis", "nightly"),
    "./run nightly --profile slurm": (RUN, "test_what_it_asks_of_the_analysis", "--profile slurm"),
    "build/bin/fringe capacitance hand.toml": (README, "test_the_model_prints_what_the_readme_shows", "capacitance hand.toml"),
    "build/bin/fringe capacitance hand.toml --method boundary-elements": (README, "test_boundary_elements_print_what_the_guide_shows", "--method boundary-elements"),
    "build/bin/fringe capacitance geometries/scenes/guarded_sensor.toml --method boundary-elements": ("model/test_readings.py", "test_the_table_has_a_line_for_every_reading", ""),
    "build/bin/fringe sweep geometries/scenes/guarded_sensor.toml --method boundary-elements --rtol 0.02 --output sweep.csv": ("model/test_sweep.py", "test_the_guide_shows_what_the_command_prints", "guarded_sensor.toml"),
    "python3 -m analysis show position_sensor --readings": ("analysis/show/test_show.py", "test_readings_along_the_motion_are_those_of_the_library", "--readings"),
    "python3 -m analysis live sensor_head": ("analysis/live/test_paths.py", "test_every_option_of_the_command_acts", "live"),
    "python3 -m analysis live SCENE": ("analysis/live/test_paths.py", "test_every_option_of_the_command_acts", "live"),
    "python3 -m analysis sweep SCENE": ("analysis/sweep/test_sweep_page.py", "test_the_command_makes_a_page_and_its_table_from_its_options", "sweep"),
    "cmake --install build --prefix ~/fringe": ("packaging/test_tutorial.py", "test_the_commands_print_what_the_tutorial_shows", "prefix"),
    "fringe sweep": ("model/test_sweep.py", "test_every_frame_has_the_reading_of_the_scene_in_its_poses", "sweep"),
    "fringe sweep SCENE": ("model/test_sweep.py", "test_every_frame_has_the_reading_of_the_scene_in_its_poses", "sweep"),
    "fringe capacitance SCENE --frame NAME": ("model/test_sweep.py", "test_capacitance_answers_in_one_frame", "--frame"),
    'fringe capacitance SCENE --frame "10 cm"': ("model/test_sweep.py", "test_capacitance_answers_in_one_frame", "--frame"),
    "build/bin/fringe capacitance hand.toml --output triangles.vtu": (README, "test_the_file_for_paraview_is_written", "--output triangles.vtu"),
    "build/bin/fringe capacitance SCENE --method boundary-elements --rtol 1e-05": ("analysis/topics/published/test_table.py", "test_rows_drawn_by_chance_are_found_again", ""),
    "cmake --install build --prefix /usr/local": ("packaging/conftest.py", "prefix", "--prefix"),
    "./run --prepare": (RUN, "test_it_waits_for_another_package_manager_and_says_so", "./run"),
    "./run --prepare TARGET…": (RUN_SCRIPT, "test_only_what_is_named_is_prepared", "--prepare"),
    "./run --python": ("end_to_end/test_run_script.py", "test_it_prints_the_python_that_has_the_field_solver", "--python"),
    "fringe capacitance SCENE": ("model/test_command_line.py", "test_capacitance_as_json", "capacitance"),
    "fringe export SCENE FILE": ("end_to_end/test_export.py", "test_the_capacitors_of_a_circuit_are_the_matrix", "export"),
    "fringe import SOURCE SCENE": (IMPORT, "test_links_and_joints_at_zero_are_links_and_poses", "import"),
    "fringe import --missing leave-out": ("end_to_end/test_import_robots.py", "test_one_bad_mesh_is_told_and_stops_the_rest_only_if_it_shall", "--missing"),
    "fringe import": (IMPORT, "test_links_and_joints_at_zero_are_links_and_poses", "import"),
    "fringe info": ("model/test_command_line.py", "test_info_counts_the_defects_of_a_mesh", "info"),
    "fringe sense SCENE": ("model/test_sense_command.py", "test_sense_as_json", "sense"),
    "fringe capacitance … --output FILE.vtu": ("model/test_output_file.py", "test_the_triangles_of_an_object_add_up_to_its_capacitance", "--output"),
    "fringe … --json": (OPTIONS, "test_json_in_the_place_of_a_table", "--json"),
    "pkg-config fringe": (INSTALL, "test_a_project_finds_the_library_with_pkg_config", "pkg-config"),
    "python3 -m analysis measure WHAT": ("end_to_end/test_documented_commands.py", "test_every_measure_is_known_and_loads_and_each_is_in_a_note", "measure"),
    "python3 -m analysis company": ("analysis/topics/test_topic.py", "test_the_command_computes_what_is_missing_and_page_and_report_show_it", "company"),
    "python3 -m analysis corrections": ("analysis/topics/corrections/test_corrections.py", "test_every_set_up_is_told_with_its_truth_and_opened_by_its_point", "corrections"),
    "python3 -m analysis diff OLD NEW --output difference.json": ("analysis/topics/trends/test_trends.py", "test_drift_ends_with_code_1_a_table_and_a_document", "diff"),
    "python3 -m analysis documentation": ("analysis/documentation/test_documentation.py", "test_the_site_is_made_without_a_warning", "documentation"),
    "python3 -m analysis golden NEW --against FILE": ("analysis/golden/test_run.py", "test_every_option_of_the_command_acts", "--against"),
    "python3 -m analysis errors": ("analysis/topics/test_topic.py", "test_the_command_computes_what_is_missing_and_page_and_report_show_it", "errors"),
    "python3 -m analysis measure truths machines": ("analysis/topics/test_stored.py", "test_the_commands_solve_by_topic_and_tell_what_is_left", "truths"),
    "python3 -m analysis machines": ("analysis/topics/test_topic.py", "test_the_command_computes_what_is_missing_and_page_and_report_show_it", "machines"),
    "python3 -m analysis insulators": ("analysis/topics/test_topic.py", "test_the_command_computes_what_is_missing_and_page_and_report_show_it", "insulators"),
    "python3 -m analysis measure truths insulators": ("analysis/topics/test_stored.py", "test_the_commands_solve_by_topic_and_tell_what_is_left", "truths"),
    "python3 -m analysis measure field-check insulators": ("analysis/topics/test_stored.py", "test_the_commands_solve_by_topic_and_tell_what_is_left", "insulators"),
    "python3 -m analysis nightly STUDY": ("analysis/nightly/test_night.py", "test_the_next_night_solves_only_what_is_missing_and_tells_what_is_new", "nightly"),
    "python3 -m analysis trends": ("analysis/topics/trends/test_trends.py", "test_the_command_tells_all_alarms_and_makes_the_page", "trends"),
    "python3 -m analysis trends --bisect VALUE": ("analysis/topics/trends/test_trends.py", "test_the_command_bisects", "--bisect"),
    "python3 -m analysis trends --count HEAD~10..": ("analysis/topics/trends/test_trends.py", "test_the_command_counts_before_it_tells", "--count"),
    "python3 -m analysis run STUDY --measure-model": (OPTIONS, "test_an_option_reaches_what_it_is_for", "--measure-model"),
    "python3 -m analysis measure benchmarks": ("analysis/documentation/test_measurements.py", "test_tables_are_replaced_and_nothing_else", "benchmarks"),
    "python3 -m fem_reference SCENE": (README, "test_the_reference_agrees_with_what_the_readme_shows", "fem_reference"),
    "python3 -m analysis run STUDY": ("end_to_end/test_run.py", "", "run"),
    "python3 -m analysis verify": (OPTIONS, "test_an_option_reaches_what_it_is_for", "verify"),
    "python3 -m analysis measure field-check machines": ("analysis/topics/test_stored.py", "test_the_commands_solve_by_topic_and_tell_what_is_left", "machines"),
    "python3 -m analysis measure field-check company": ("analysis/topics/test_stored.py", "test_the_commands_solve_by_topic_and_tell_what_is_left", "company"),
    "python3 -m analysis measure corrections": ("analysis/topics/corrections/test_corrections.py", "test_the_table_of_errors_is_the_one_computed", "corrections"),
    "python3 -m analysis measure truths corrections": ("analysis/topics/corrections/test_corrections.py", "test_stored_truths_are_what_boundary_elements_say", "truths"),
    "python3 -m fem_reference analysis/documentation/hand.toml --error estimate --rtol 1e-3": ("fem_reference/test_command_line.py", "test_json_is_one_document_with_the_whole_answer", "estimate"),
    "python3 -m fem_reference analysis/documentation/hand.toml --rtol 2e-3": (README, "test_the_reference_agrees_with_what_the_readme_shows", "fem_reference"),
    "python3 -m fem_reference hand.toml": (README, "test_the_reference_agrees_with_what_the_readme_shows", "fem_reference"),
    "python3 -m geometries.studies.schema": ("geometries/test_schemas.py", "test_the_schema_of_studies_is_that_of_the_families", "schema"),
    "python3 -m tests.analysis.nightly.kill_cluster_nights": ("end_to_end/test_cluster.py", "test_jobs_end_with_a_night_that_is_asked_to_end_and_before_what_follows_one_that_is_killed", "kill_cluster_nights"),
    "python3 -m tests.analysis.nightly.kill_nights": ("analysis/nightly/test_night.py", "test_nights_that_are_killed_lose_nothing_and_leave_nothing_in_the_way", "kill_nights"),
    "python3 -m tests.faults.run": ("faults/test_faults.py", "test_nothing_is_lost_it_is_told_and_the_next_run_completes", "faults.run"),
    "python3 -m tests.model.instruction_counts": ("model/test_instruction_counts.py", "test_recording_tells_every_change", "instruction_counts"),
    "tests/end_to_end/one_machine_slurm start results/slurm": ("analysis/nightly/kill_cluster_nights.py", "one_machine", "one_machine_slurm"),
    "tests/end_to_end/one_machine_slurm stop results/slurm": ("analysis/nightly/kill_cluster_nights.py", "one_machine", "one_machine_slurm"),
    "tests/end_to_end/one_machine_slurm": ("analysis/nightly/kill_cluster_nights.py", "one_machine", "one_machine_slurm"),
}  # fmt: skip
# Of minutes, also when they are asked for little.
MINUTES = {
    "python3 -m tests.fem_reference.random_set_ups": "python3 -m tests.fem_reference.random_set_ups --count 2",
    "python3 -m tests.fem_reference.invariances": "python3 -m tests.fem_reference.invariances --first 31 --count 1",
    "build/bin/boundary_elements_benchmark": "build/bin/boundary_elements_benchmark",
    "build/bin/boundary_element_scenes_benchmark": "build/bin/boundary_element_scenes_benchmark",
    "build/bin/reduced_benchmark --moving SCENE POSES": "build/bin/reduced_benchmark --moving geometries/scenes/guarded_sensor.toml 2",
    "build/bin/reduced_benchmark --covers 12": "build/bin/reduced_benchmark --covers 1",
    "build/bin/reduced_benchmark --machine 3": "build/bin/reduced_benchmark --machine 0",
    "build/bin/reduced_benchmark --meshes 40": "build/bin/reduced_benchmark --meshes 1",
    "build/bin/reduced_benchmark SCENE…": f"build/bin/reduced_benchmark {HAND}",
    "tests/fuzz/run SECONDS": "tests/fuzz/run 20",
}
# Commands that are not run here: they build the programs, run these tests, or are a step of `check --all`.
ABOVE = {"./check", "./check --all", "cmake --preset release && cmake --build build", "tests/clean/run"}
_STARTS = re.compile(
    r"\./run|\./check|build/bin/|python3 -m [a-z]|tests/[\w/]+(?=[ `]|$)|fringe [a-z…]|cmake |\(cd build|pkg-config |sha256sum |[a-z_]+_benchmark"
)


def given() -> dict[str, set[str]]:
    """Every command in the repository's notes, and where it is; the tutorial's have a test that runs them all. The changelog may also tell of
    commands that are no more."""
    found: dict[str, set[str]] = {}
    listed = subprocess.run(["git", "ls-files", "*.md"], cwd=ROOT, capture_output=True, text=True, check=True)
    for file in listed.stdout.split():
        text = re.sub(r"```.*?```", "", (ROOT / file).read_text(encoding="utf-8"), flags=re.DOTALL)
        blocks = [
            re.split(r" {2,}#", line.strip().removeprefix("$ "))[0].strip()
            for line in text.splitlines()
            if line.startswith("    ")
        ]
        for command in [*blocks, *re.findall(r"`([^`\n]+)`", text)]:
            if _STARTS.match(command):
                found.setdefault(command, set()).add(file)
    known = {*SMALL, *ELSEWHERE, *MINUTES, *ABOVE}
    return {
        command: files for command, files in found.items() if files != {"CHANGELOG.md"} or command in known
    }


def is_tested(command: str) -> bool:
    """Whether it builds and runs tests that exist, or names a program by its bare name that others give with its place."""
    steps = command.split(" && ")
    if all(
        re.match(r"cmake --build build --target |ctest |python3 -m pytest |build/bin/ROOM_tests ", step)
        for step in steps
    ):
        named = [word for word in command.split() if word.startswith("tests/")]
        return all((ROOT / word.removesuffix("/FOLDER")).exists() for word in named)
    return (ROOT / command).is_dir() or f"build/bin/{command}" in {
        name.split()[0] for name in [*SMALL, *MINUTES]
    }


def test_the_table_has_every_command_and_no_other() -> None:
    known = {*SMALL, *ELSEWHERE, *MINUTES, *ABOVE}
    commands = given()
    assert not {
        command: commands[command] for command in commands if command not in known and not is_tested(command)
    }
    assert not known - set(commands)


@pytest.mark.parametrize("command", ELSEWHERE)
def test_a_command_has_its_test(command: str) -> None:
    file, name, word = ELSEWHERE[command]
    text = (ROOT / "tests" / file).read_text(encoding="utf-8")
    assert f"def {name}" in text
    assert word in command and word.removeprefix("./") in text


@pytest.mark.parametrize("command", {**SMALL, **MINUTES})
def test_a_command_of_a_module_has_it(command: str) -> None:
    if command.startswith("python3 -m "):
        module = ROOT / command.split()[2].replace(".", "/")
        assert module.with_suffix(".py").is_file() or (module / "__main__.py").is_file()


def test_every_measure_is_known_and_loads_and_each_is_in_a_note() -> None:
    named = {
        match[1]
        for command in given()
        if (match := re.match(r"python3 -m analysis measure ([a-z-]+)", command))
    }
    assert named == set(MEASURES)
    for each in MEASURES.values():
        assert callable(import_module(each.module).measure)


@pytest.mark.night
@pytest.mark.parametrize("command", SMALL)
def test_a_command_works(tmp_path: Path, command: str) -> None:
    if "convert" in command:
        import meshio

        meshio.write(
            tmp_path / "in.vtu", meshio.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [("triangle", [[0, 1, 2]])])
        )
    run(SMALL[command].replace("{out}", shlex.quote(str(tmp_path))))


@pytest.mark.night
@pytest.mark.parametrize("command", MINUTES)
def test_a_command_of_minutes_works(command: str) -> None:
    run(MINUTES[command])


def run(command: str) -> None:
    words = shlex.split(command)
    if words[0] == "python3":
        words[0] = sys.executable
    assert shutil.which(words[0], path=f"{ROOT}:{os.environ['PATH']}") or (ROOT / words[0]).is_file(), words[
        0
    ]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, timeout=DEADLINE)
    assert done.returncode == 0 and (done.stdout or done.stderr), done.stderr
