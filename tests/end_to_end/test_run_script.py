"""./run works wherever the user stands, and beside another package manager. A small study from the command line: real meshes, real
field solves, the real model."""

import csv
import fcntl
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests import scenes
from tests.analysis.synthetic import HEAD
from tests.by_night import all_but
from tests.geometries import schemas
from tests.waiting import DEADLINE

ROOT = Path(__file__).resolve().parents[2]


def test_a_folder_named_like_ours_where_the_user_stands_is_not_taken_for_ours(tmp_path: Path) -> None:
    folder = empty_repository(tmp_path, "cmake")
    (folder / "analysis" / "__main__.py").write_text("import geometries, sys\nsys.exit(f'{sys.argv[1:]}')\n")
    for name in ("analysis", "geometries"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text("raise SystemExit('the wrong package')")
    (tmp_path / "a study.toml").touch()
    command, path = [folder / "run", "a study.toml"], {"PATH": f"{folder}:{os.environ['PATH']}"}
    done = subprocess.run(
        command, cwd=tmp_path, env=os.environ | path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 1 and done.stderr == "['run', 'a study.toml']\n"


def test_help_and_a_name_that_is_no_study_are_answered_before_anything_is_installed(tmp_path: Path) -> None:
    folder = empty_repository(tmp_path, "cmake")
    assert "./run [STUDY]" in run_in(folder, "./run --help")
    for name in ("nowhere", "--fast"):
        done = subprocess.run([folder / "run", name], capture_output=True, text=True, check=False)
        assert done.returncode == 2 and f"run: {name}: is neither a study" in done.stderr
    assert not (folder / "build").exists()


OF_THE_DEFAULT = """run default
errors
corrections
company
machines
insulators
show position_sensor --readings
live sensor_head
run default --measure-model""".splitlines()


@pytest.mark.parametrize(
    ("given", "known", "installed", "asked"),
    [
        ("./run", "", ["first", "first second"], OF_THE_DEFAULT),
        ("./run experiment_1", "first", [], ["run experiment_1"]),
        ("./run nightly --profile slurm", "", ["first second"], ["nightly nightly --verify --profile slurm"]),
        ("./run --prepare", "first", ["second"], []),
    ],
)
def test_what_it_installs_and_what_it_asks_of_the_analysis(
    tmp_path: Path, given: str, known: str, installed: list[str], asked: list[str]
) -> None:
    folder = empty_repository(tmp_path, "cmake", "em++", "apt-get")
    tells = f"echo '{known} install ok installed'" if known else "exit 1"
    for program, does in {"dpkg-query": tells, "sudo": 'exec "$@"'}.items():
        (folder / program).write_text(f"#!/bin/sh\n{does}\n")
        (folder / program).chmod(0o755)
    (folder / "packages.txt").write_text("# build\nfirst\n# -- the rest\n# documentation\nsecond\n")
    printed = run_in(folder, given)
    assert re.findall("apt-get -q install -y --no-install-recommends (.*)", printed) == installed
    assert ("Installing" in printed) == bool(installed)
    assert re.findall(r"asked: (.*)", printed) == asked
    browsers = folder / "build-browser" / "build.log"
    assert browsers.is_file() == (given == "./run")
    if given == "./run":
        assert "cmake --preset browser" in browsers.read_text()
        # The report is told before anything is installed or built that it does not need.
        told = [
            "recommends first",
            "Building study_programs",
            "asked: run default",
            "results/default/report.html",
            "Still to come",
            "recommends first second",
            "Building product measurements",
            "for browsers",
        ]
        places = [printed.index(words) for words in told]
        assert places == sorted(places)


@pytest.mark.night
def test_only_what_is_named_is_prepared(tmp_path: Path) -> None:
    folder = empty_repository(tmp_path, "cmake", "em++")
    log = folder / "build" / "build.log"
    for words, built in (("", "product"), ("product test_programs", "product test_programs")):
        printed = run_in(folder, f"./run --prepare {words}")
        assert f"--target {built}\n" in log.read_text() and "asked:" not in printed
    assert not (folder / "build-browser").exists()
    run_in(folder, "./run --prepare browser")
    assert (folder / "build-browser" / "build.log").is_file()


@pytest.mark.night
def test_without_emscripten_it_says_that_there_is_no_live_page(tmp_path: Path) -> None:
    folder = empty_repository(tmp_path, "cmake")
    (tmp_path / "bin").mkdir()
    for program in Path("/usr/bin").iterdir():
        if program.name not in ("em++", "cmake"):
            (tmp_path / "bin" / program.name).symlink_to(program)
    printed = run_in(folder, "./run", str(tmp_path / "bin"))
    assert "Without emscripten (em++) the library is not built for browsers" in printed
    assert "asked: run default" in printed and "asked: live" not in printed


def empty_repository(place: Path, *programs: str) -> Path:
    """A repository with nothing in it: no package is missing, the programs only say how they were called, and so does the analysis."""
    folder = place / "a repository"
    (folder / "analysis").mkdir(parents=True)
    (folder / "analysis" / "__main__.py").write_text("import sys\nprint('asked:', *sys.argv[1:])\n")
    (folder / "packages.txt").write_text("# none\n")
    (folder / "geometries" / "studies").mkdir(parents=True)
    for study in ("default", "experiment_1"):
        (folder / "geometries" / "studies" / f"{study}.toml").touch()
    for program in programs:
        (folder / program).write_text(f'#!/bin/sh\necho "{program} $*"\n')
        (folder / program).chmod(0o755)
    shutil.copy(ROOT / "run", folder / "run")
    return folder


def run_in(folder: Path, given: str, path: str = os.environ["PATH"]) -> str:
    """What ./run of a repository prints, called elsewhere; the repository's programs stand before those of the path."""
    command = [str(folder / "run"), *given.split()[1:]]
    more = os.environ | {"PATH": f"{folder}:{path}"}
    return subprocess.run(
        command, env=more, cwd=folder.parent, capture_output=True, text=True, check=True
    ).stdout


def test_it_prints_the_python_that_has_the_field_solver() -> None:
    done = subprocess.run([ROOT / "run", "--python"], capture_output=True, text=True, check=True)
    has = "from importlib.util import find_spec; assert find_spec('dolfinx') and find_spec('gmsh')"
    subprocess.run([done.stdout.strip(), "-c", has], check=True)


@pytest.fixture
def new_machine(tmp_path: Path) -> Path:
    """A repository that needs one package, and Debian's apt-get with folders of its own, where that package is missing.

    Stand-ins take the places of dpkg, which changes nothing but prints what it was asked, of dpkg-query, sudo and cmake.
    """
    machine = tmp_path / "machine"
    for folder in (
        "archive/DEBIAN",
        "bin",
        "cache/archives/partial",
        "dpkg",
        "etc/apt.conf.d",
        "etc/preferences.d",
        "log",
        "repository",
        "state/lists/partial",
    ):
        (machine / folder).mkdir(parents=True)
    (machine / "archive/DEBIAN/control").write_text(
        "Package: wanted\nVersion: 1\nArchitecture: all\nMaintainer: nobody <nobody@localhost>\nDescription: empty\n"
    )
    subprocess.run(["dpkg-deb", "-b", "archive", "etc/wanted_1_all.deb"], cwd=machine, check=True)
    found = subprocess.run(["dpkg-scanpackages", "."], cwd=machine / "etc", capture_output=True, check=True)
    (machine / "etc/Packages").write_bytes(found.stdout)
    (machine / "etc/sources.list").write_text(f"deb [trusted=yes] file:{machine}/etc ./\n")
    (machine / "dpkg/status").touch()
    (machine / "apt.conf").write_text(
        f'Dir::State "{machine}/state/"; Dir::State::status "{machine}/dpkg/status"; Dir::Cache "{machine}/cache/";\n'
        f'Dir::Etc "{machine}/etc/"; Dir::Log "{machine}/log/"; Dir::Bin::dpkg "{machine}/bin/dpkg"; APT::Sandbox::User "";\n'
    )

    for program, does in {
        "cmake": "exit 0",
        "dpkg": 'echo "asked of dpkg: $*"',
        "dpkg-query": "exit 1",
        "sudo": 'exec "$@"',
    }.items():
        (machine / "bin" / program).write_text(f"#!/bin/sh\n{does}\n")
        (machine / "bin" / program).chmod(0o755)
    (machine / "repository/packages.txt").write_text("wanted\n")
    shutil.copy(ROOT / "run", machine / "repository/run")
    return machine


def prepare(machine: Path) -> subprocess.Popen[str]:
    path = f"{machine / 'bin'}:{os.environ['PATH']}"
    return subprocess.Popen(
        [machine / "repository/run", "--prepare"],
        env=os.environ | {"PATH": path, "APT_CONFIG": str(machine / "apt.conf")},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


LOCKS = ["dpkg/lock-frontend", "dpkg/lock", "state/lists/lock", "cache/archives/lock"]


@pytest.mark.parametrize("lock", all_but(LOCKS[:1], LOCKS))
def test_it_waits_for_another_package_manager_and_says_so(new_machine: Path, lock: str) -> None:
    with (new_machine / lock).open("w") as held:
        fcntl.lockf(held, fcntl.LOCK_EX)
        running = prepare(new_machine)
        assert running.stdout is not None
        lines = []
        for line in running.stdout:
            lines.append(line)
            if line.startswith("Waiting for another package manager."):
                break
        assert f"Could not get lock {new_machine / lock}. It is held by process {os.getpid()}" in lines[-1]
        assert "asked of dpkg" not in "".join(lines)
    rest, _ = running.communicate(timeout=DEADLINE)
    assert running.returncode == 0, rest
    assert "Waiting" not in rest
    assert re.search("asked of dpkg: .*--unpack .*wanted_1_all.deb", rest)


def test_what_is_no_lock_is_not_waited_for(new_machine: Path) -> None:
    (new_machine / "repository/packages.txt").write_text("unknown-package\n")
    running = prepare(new_machine)
    printed, _ = running.communicate(timeout=DEADLINE)
    assert running.returncode == 1
    assert "Unable to locate package unknown-package" in printed and "Waiting" not in printed


STUDY = HEAD.replace("1e-3", "1e-2") + scenes.sweep("parallel", gap=0.05)


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The results of a study, in a folder with a space."""
    folder = tmp_path_factory.mktemp("quick results")
    (folder / "quick.toml").write_text(STUDY)
    command = [sys.executable, "-m", "analysis", "run", folder / "quick.toml", "--results", folder / "quick"]
    finished = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert finished.returncode == 0, finished.stderr
    assert f"report: {folder / 'quick' / 'report.html'}" in finished.stdout
    return folder / "quick"


def test_the_table_has_both_quantities_with_small_reference_errors(results: Path) -> None:
    rows = list(csv.DictReader((results / "table.csv").open()))
    assert [(row["family"], row["quantity"]) for row in rows] == [
        ("parallel", "mutual"),
        ("parallel", "delta_self"),
    ]
    for row in rows:
        assert row["reached"] == "True"
        # The study asks for one per cent of the matrix; delta_self is smaller than its entries.
        assert 0 < float(row["reference_error_F"]) < 0.05 * float(row["reference_F"])
        assert float(row["model_error_low"]) < float(row["model_error"]) < float(row["model_error_high"])


@pytest.mark.parametrize(
    ("name", "files", "count"),
    [
        ("reference", "cases/*/fem.json", 2),
        ("model", "cases/*/model.json", 1),
        ("slice", "cases/*/slice.json", 1),
        ("results", "study.json", 1),
    ],
)
def test_stored_answers_are_what_the_schemas_say(results: Path, name: str, files: str, count: int) -> None:
    found = list(results.glob(files))
    assert len(found) == count
    for path in found:
        schemas.validator(name).validate(json.loads(path.read_text()))


def test_the_parallel_plates_agree_with_the_published_capacitance(results: Path) -> None:
    """Two-terminal capacitance of equal squares at gap/side 0.5: 2.2364 of the plate formula, to 1e-4."""
    row = next(csv.DictReader((results / "table.csv").open()))
    mutual = float(row["reference_F"])
    matrix = json.loads((results / "cases" / row["case"] / "fem.json").read_text())["maxwell"]
    whole = (matrix[0][0] * matrix[1][1] - mutual**2) / (matrix[0][0] + matrix[1][1] - 2 * mutual)
    assert whole / (8.8541878128e-12 * 0.1**2 / 0.05) == pytest.approx(2.2364, rel=2e-3)


def test_the_page_of_the_case_has_a_picture_of_the_potential(results: Path) -> None:
    (page,) = [
        path.read_text() for path in results.glob("cases/*/case.html") if "parallel" in path.read_text()
    ]
    assert "potential (V) in the vertical plane" in page
