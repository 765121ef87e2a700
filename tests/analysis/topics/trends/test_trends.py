"""The trends of a study's nights: what a night appends, the page, `diff`, and the commit of a change. What is marked in the values of
many commits: a change beyond errors, a drift, more instructions; and what is held back."""

import json
import math
import re
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from analysis.study import report
from analysis.topics.trends import changes, commits, page
from analysis.topics.trends.changes import DRIFTED, FASTER, MOVED, SLOWER, Record
from geometries.common.errors import InputError
from tests.analysis.documents import model_document, reference_document
from tests.analysis.synthetic import make_results
from tests.programs import analysis


def answer(folder: Path, mutual: float, key: str) -> None:
    """The field solver has answered the first case anew."""
    report.make(
        make_results(folder, answers={0: (reference_document(mutual, 1) | {"key": key}, model_document(1.8))})
    )


def count(instructions: int) -> Record:
    return changes.of_count("workload", instructions, "true", str(instructions), "valgrind 3")


def test_a_night_appends_what_is_new_with_its_origin(tmp_path: Path) -> None:
    answer(tmp_path, 2.0, "first")
    first = changes.add(tmp_path, [*changes.of_night(tmp_path), count(1000)])
    kinds = {"field solver", "model exact", "model split:0", changes.INSTRUCTIONS}
    assert {each.kind for each in first} >= kinds
    assert changes.add(tmp_path, [*changes.of_night(tmp_path), count(1000)]) == []
    answer(tmp_path, 2.1, "second")
    (mutual, delta_self, counted) = changes.add(tmp_path, [*changes.of_night(tmp_path), count(1100)])
    assert changes.load(tmp_path) == [*first, mutual, delta_self, counted]
    assert mutual.name.startswith("mutual sensor target, parallel ") and mutual.name.endswith(mutual.case)
    assert (mutual.value, mutual.error) == pytest.approx((2.1e-12, 0.01e-12))
    assert mutual.inputs == "second" and "dolfinx 0.5.2" in mutual.versions
    assert mutual.command.startswith("python3 -m fem_reference ") and mutual.command.endswith(" --json")
    assert len(mutual.commit) >= 40 and mutual.processor and mutual.time > first[0].time
    assert [mark.after for mark in changes.marks(changes.load(tmp_path))] == [counted, mutual]


def test_a_line_that_a_killed_night_left_unfinished_is_written_again(tmp_path: Path) -> None:
    answer(tmp_path, 2.0, "first")
    whole = changes.add(tmp_path, changes.of_night(tmp_path))
    file = tmp_path / changes.FILE
    file.write_text(file.read_text()[:-10])
    assert changes.load(tmp_path) == whole[:-1]
    (again,) = changes.add(tmp_path, changes.of_night(tmp_path))
    assert again.series == whole[-1].series and len(changes.load(tmp_path)) == len(whole)


def test_a_value_that_is_not_finite_is_kept_as_unknown(tmp_path: Path) -> None:
    answer(tmp_path, math.inf, "first")
    changes.add(tmp_path, changes.of_night(tmp_path))
    assert "Infinity" not in (tmp_path / changes.FILE).read_text()
    assert any(math.isnan(each.value) for each in changes.load(tmp_path))
    assert changes.add(tmp_path, changes.of_night(tmp_path)) == []


def written(folder: Path, found: list[Record]) -> Path:
    """Results with these records in place of their own."""
    make_results(folder)
    lines = [json.dumps(vars(each)) + "\n" for each in found]
    (folder / changes.FILE).write_text("".join(lines))
    return page.make(folder)


def test_the_page_shows_every_value_over_the_commits_and_marks_changes(tmp_path: Path) -> None:
    moved = nights([2.0] * 6 + [2.5] * 6, name="moved")
    counted = nights([1000.0] * 8 + [1200.0] * 4, error=5.0, kind=changes.INSTRUCTIONS, name="workload")
    text = written(tmp_path, moved + nights([3.0] * 12, name="steady") + counted).read_text()
    assert "3 values over 12 commits: 2 of them have changed by more than their errors allow" in text
    assert (
        "field solver, since the first night: 2 values" in text
        and "instructions, since the first night" in text
    )
    assert text.count('"x",') == 2 and "c5 … c6" in text and "+20.00 %" in text
    assert text.count('<td class="text">steady</td>') == 1
    (tmp_path / "data").is_dir()
    for target in re.findall(r'(?:href|src)="([^"]*\.csv|[^"]*\.js)"', text):
        assert (tmp_path / target).is_file()


def test_the_page_folds_what_is_held_back(tmp_path: Path) -> None:
    moved = [each for n in range(3) for each in nights([2.0] * 6 + [2.5] * 6, name=f"moved {n}")]
    found = [replace(each, processor="new") if each.time >= "0006" else each for each in moved]
    text = written(tmp_path, found).read_text()
    assert "none has changed by more than its errors allow" in text and "Show 3 changes" in text


def test_the_command_tells_all_alarms_and_makes_the_page(tmp_path: Path) -> None:
    written(tmp_path, nights([2.0] * 6 + [2.5] * 6))
    printed = analysis("trends", tmp_path).stdout
    assert "field solver: a: moved, 2 -> 2.5 (+2.50e-01), 2.5 times" in printed and page.PAGE in printed


def git(folder: Path, *words: str) -> str:
    who = ["-c", "user.name=nobody", "-c", "user.email=nobody@localhost"]
    return subprocess.run(
        ["git", "-C", str(folder), *who, *words], capture_output=True, text=True, check=True
    ).stdout.strip()


@pytest.fixture(scope="module")
def repository(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[str]]:
    """Ten commits of a program that prints a matrix, of which the seventh changes an entry; the sixth does not build."""
    folder = tmp_path_factory.mktemp("repository")
    git(folder, "init", "--quiet")
    commits = []
    for at in range(10):
        (folder / "answer.json").write_text(
            json.dumps({"at": at, "maxwell": [[9, -2.5 if at >= 6 else -2.0]]})
        )
        (folder / "builds").write_text("false" if at == 5 else "true")
        git(folder, "add", "--all")
        git(folder, "commit", "--quiet", "--message", f"commit {at}")
        commits.append(git(folder, "rev-parse", "HEAD"))
    return folder, commits


def nights_of(commits: list[str], command: str) -> list[Record]:
    known = nights([2.0, 2.5], name="mutual")
    return [replace(each, commit=commit, command=command) for each, commit in zip(known, commits)]


def test_the_commit_of_a_change_is_found_by_building_and_asking_again(
    tmp_path: Path, repository: tuple[Path, list[str]]
) -> None:
    folder, known = repository
    written(tmp_path, nights_of([known[0], known[-1]], "cat answer.json"))
    said = commits.find(tmp_path, "field solver: mutual", folder, build="true")
    assert f"{known[6]} is the first bad commit" in said and "commit 6" in said
    assert len(git(folder, "worktree", "list").splitlines()) == 1


def test_commits_that_do_not_build_are_passed_over(
    tmp_path: Path, repository: tuple[Path, list[str]]
) -> None:
    folder, known = repository
    written(tmp_path, nights_of([known[4], known[7]], "cat answer.json"))
    said = commits.find(tmp_path, "mutual", folder, build="sh builds")
    assert "only 'skip'ped commits left" in said and known[5] in said and known[6] in said


@pytest.mark.parametrize(
    ("name", "which", "reason"),
    [
        ("nothing", slice(0, 2), "is no value that has changed"),
        ("mutual", slice(0, 1), "has not changed between two commits that are known"),
    ],
)
def test_what_has_no_commits_to_look_at_is_refused(
    name: str, which: slice, reason: str, tmp_path: Path, repository: tuple[Path, list[str]]
) -> None:
    folder, known = repository
    written(tmp_path, nights_of((known[which] * 2)[:2], "cat answer.json"))
    with pytest.raises(InputError, match=reason):
        commits.find(tmp_path, name, folder, build="true")


def test_numbers_are_found_in_text_too(tmp_path: Path, repository: tuple[Path, list[str]]) -> None:
    folder, known = repository
    written(tmp_path, nights_of([known[0], known[-1]], "echo Collected : $(cut -b 2- answer.json)"))
    assert f"{known[6]} is the first bad commit" in commits.find(tmp_path, "mutual", folder, build="true")


def test_workloads_are_counted_at_each_commit_and_a_planted_regression_is_found(
    tmp_path: Path, repository: tuple[Path, list[str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The program of a commit takes 400 times the second entry of its matrix, and the sixth has none."""
    folder, known = repository

    def counted(program: Path) -> list[Record]:
        (row,) = json.loads((program.parents[2] / "answer.json").read_text())["maxwell"]
        return [count(round(-400 * row[1]))]

    monkeypatch.setattr(commits, "of_build", counted)
    found = list(commits.count_each(tmp_path / "trends", "--all", folder, build="sh builds"))
    assert [commit for commit, _ in found] == known
    assert [len(new) for _, new in found] == [1, 0, 0, 0, 0, 0, 1, 0, 0, 0]
    (mark,) = changes.marks(changes.load(tmp_path / "trends"))
    assert (mark.what, mark.before.commit, mark.after.commit) == (changes.SLOWER, known[0], known[6])
    told = analysis("trends", tmp_path / "trends").stdout
    assert "instructions: workload: more instructions, 800 -> 1000" in told


def test_the_command_counts_before_it_tells(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(commits, "count_each", lambda folder, which: [(f"{folder.name} {which}", [])])
    told = analysis("trends", tmp_path, "--count", "HEAD~3..").stdout
    assert f"{tmp_path.name} HEAD~3..: 0 counts are new" in told


def test_the_command_bisects(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(commits, "find", lambda folder, name: f"{folder} {name}\n")
    assert analysis("trends", tmp_path, "--bisect", "mutual").stdout == f"{tmp_path} mutual\n"


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Results in which one case's mutual is 2.0 ± 0.01 pF, then 2.1 ± 0.01 pF."""
    place = tmp_path_factory.mktemp("results")
    for name, mutual in (("old", 2.0), ("new", 2.1)):
        answer(place / name, mutual, "")
    return place / "old", place / "new"


def test_drift_ends_with_code_1_a_table_and_a_document(folders: tuple[Path, Path], tmp_path: Path) -> None:
    document = tmp_path / "difference.json"
    printed = analysis("diff", *folders, "--output", document, status=1).stdout
    assert "1 values moved by more than their errors" in printed and "+5.00e-02" in printed
    (told,) = json.loads(document.read_text())["moved"]
    assert told["after"]["kind"] == "field solver" and told["over"] == pytest.approx(5)


def test_no_drift_ends_with_code_0_for_folders_and_tables(folders: tuple[Path, Path]) -> None:
    old, _ = folders
    assert "40 values in both, 0 new, 0 gone" in analysis("diff", old, old / "table.csv").stdout


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (None, "cannot be read"),
        ("a,b\n1,2\n", "is missing from the columns of this table"),
        ("case,family,quantity,sensor,object,field_F\na,b,c,d,e,x\n", "line 2: is not a row of a table"),
    ],
)
def test_wrong_tables_end_with_code_2_and_a_reason(
    text: str | None, told: str, folders: tuple[Path, Path], tmp_path: Path
) -> None:
    wrong = tmp_path / "wrong.csv"
    if text is not None:
        wrong.write_text(text)
    done = analysis("diff", folders[0], wrong, status=2)
    assert told in done.stderr and not done.stdout


COMMITS = 12


def nights(
    values: list[float], error: float = 0.1, kind: str = "field solver", name: str = "a"
) -> list[Record]:
    """One value over so many commits, on one machine."""
    return [
        Record(kind, name, "", value, error, 10.0, processor="old", commit=f"c{at}", time=f"{at:04}")
        for at, value in enumerate(values)
    ]


def told(found: list[Record]) -> list[tuple[str, str, str]]:
    return [(mark.after.name, mark.after.commit, mark.what) for mark in changes.marks(found) if mark.is_alarm]


def test_one_regression_among_many_values_is_found_at_its_commit() -> None:
    steady = [each for n in range(20) for each in nights([2.0] * COMMITS, name=f"steady {n}")]
    regressed = nights([2.0] * 7 + [2.3] * (COMMITS - 7), name="regressed")
    assert told(steady + regressed) == [("regressed", "c7", MOVED)]
    (mark,) = changes.marks(steady + regressed)
    assert mark.before.commit == "c6"
    assert (mark.over, mark.relative) == pytest.approx((1.5, 0.15))


@pytest.mark.parametrize(
    ("before", "after", "error", "moved"),
    [
        (2.0, 2.19, 0.1, False),
        (2.0, 2.21, 0.1, True),
        (2.0, 2.31, 0.3, False),
        (2.0, math.nan, 0.1, True),
        (math.nan, math.nan, 0.1, False),
    ],
)
def test_a_value_moves_when_it_changes_by_more_than_both_errors(
    before: float, after: float, error: float, moved: bool
) -> None:
    first, last = nights([before, after])
    assert bool(told([first, replace(last, error=error)])) == moved


def test_a_mean_that_drifts_in_steps_within_the_errors_is_found_once() -> None:
    drifting = nights([2.0 + 0.03 * at for at in range(COMMITS)])
    assert told(drifting) == [("a", "c10", DRIFTED)]
    assert not told(nights([2.0 + 0.05 * (-1) ** at for at in range(COMMITS)]))


def test_more_instructions_alarm_and_fewer_do_not() -> None:
    counted = nights([1000.0] * 5 + [1040.0] * 5 + [900.0] * 2, error=5.0, kind=changes.INSTRUCTIONS)
    counted = [replace(each, seconds=10.0**at) for at, each in enumerate(counted)]
    assert told(counted) == [("a", "c5", SLOWER)], "longer times are never told"
    assert [mark.what for mark in changes.marks(counted)] == [SLOWER, FASTER]


def on_another_machine(found: list[Record], **new: str) -> list[Record]:
    """The same from the sixth commit on another machine."""
    return [replace(each, **new) if each.time >= "0006" else each for each in found]  # type: ignore[arg-type]


@pytest.mark.parametrize("new", [{"processor": "new"}, {"versions": "dolfinx 2"}])
def test_alarms_are_held_back_where_most_values_moved_on_another_machine(new: dict[str, str]) -> None:
    moving = [each for n in range(4) for each in nights([2.0] * 6 + [2.5] * 6, name=f"moving {n}")]
    steady = nights([2.0] * COMMITS, name="steady")
    held = on_another_machine(moving + steady, **new)
    assert not told(held) and sum(mark.held for mark in changes.marks(held)) == 4
    assert len(told(moving + steady)) == 4
    text = changes.to_text(changes.marks(held))
    assert text == "0 values moved by more than their errors; 4 more on another machine, where most did\n"


def test_few_values_that_move_on_another_machine_are_told_and_so_is_what_moves_later() -> None:
    moving = nights([2.0] * 6 + [2.5] * 3 + [3.0] * 3, name="moving")
    steady = [each for n in range(4) for each in nights([2.0] * COMMITS, name=f"steady {n}")]
    found = told(on_another_machine(moving + steady, processor="new"))
    assert found == [("moving", "c6", MOVED), ("moving", "c9", MOVED)]


def test_another_method_that_moved_holds_nothing_back() -> None:
    moved, found = [2.0] * 6 + [2.5] * 6, nights([2.0] * 6 + [2.5] * 6, name="own")
    for number in range(4):
        found += nights(moved, kind="model exact", name=f"{number}")
        found += nights([2.0] * COMMITS, name=f"steady {number}")
    assert told(on_another_machine(found, processor="new")) == [("own", "c6", MOVED)]
