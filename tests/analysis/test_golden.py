"""The gate between two golden files: the same answers pass, each planted change fails by its own rule; and the command in a few small cases."""

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from analysis import golden
from analysis.golden import Case, Comparison, Recorded, compared
from analysis.honesty.asking import ANSWERED, ENDED, REFUSED, Answer, Stated
from analysis.results.answers import Estimate
from tests.programs import analysis

NAME, CHANGE, FREE = "machines/one/reduced:1e-2", "reading: change", "C[sensor, hand]"
TRUE = Estimate(1.02e-12, 0.0)


def recorded(**more: Any) -> Recorded:
    """A change that holds its truth, and a quantity that states no error."""
    change = Stated(more.pop("value", 1e-12), more.pop("error", 3e-14), "reduced")
    values = {CHANGE: change, FREE: Stated(more.pop("free", 2e-12), None, "formula")}
    return Recorded("reduced:1e-2", Answer(ANSWERED, 1.0, values=values, reached=True), {CHANGE: TRUE})


def judged(new: Recorded, with_times: bool = True) -> Comparison:
    return compared({NAME: recorded()}, {NAME: new}, with_times)


def test_the_same_answers_pass_and_nothing_moved() -> None:
    found = judged(recorded())
    assert not found.faults and not found.moved and "passes" in found.text
    (row,) = found.rows.values()
    assert (row.cases, row.quantities, row.truths, row.held, row.time_ratio) == (1, 2, 1, [1, 1], 1.0)


def test_what_stays_within_all_bounds_passes_and_is_told() -> None:
    found = judged(recorded(value=1.04e-12, error=3.2e-14, free=2e-12 * (1 + 1e-12)))
    assert not found.faults
    assert [line.partition(": ")[0] for _, line in found.moved] == [NAME, NAME]
    (row,) = found.rows.values()
    assert (row.moved, row.largest_part) == (2, pytest.approx(0.04 / 1.04))
    assert (row.largest_move, row.largest_stated) == (pytest.approx(4 / 6.2), pytest.approx(3.2 / 3))
    assert "Moved: 2 quantities" in found.text


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"value": 1.07e-12, "error": 3.1e-14}, "farther than both errors"),
        ({"error": 3.4e-14}, "1.1 times the error"),
        ({"error": None}, "states no error any more"),
        ({"value": None}, "no value any more"),
        ({"error": 1e-14}, "0 truths within the stated error, 1 before"),
        ({"free": 2e-12 * (1 + 1e-6)}, "farther than both errors"),
    ],
)
def test_a_planted_change_fails(change: dict[str, float | None], word: str) -> None:
    found = judged(recorded(**change))
    assert any(word in fault for fault in found.faults)
    assert word in found.text and "fails" in found.text


def test_an_answer_that_is_gone_or_not_as_accurate_fails() -> None:
    for outcome in (REFUSED, ENDED):
        gone = replace(recorded(), answer=Answer(outcome, 1.0, "why"))
        assert f"{NAME}: was answered, is {outcome}: why" in judged(gone).faults
    short = recorded()
    short = replace(short, answer=replace(short.answer, reached=False))
    assert judged(short).faults == [f"{NAME}: no longer reaches what was asked"]


def test_an_answer_in_place_of_a_refusal_passes() -> None:
    before = replace(recorded(), answer=Answer(REFUSED, 1.0, "why"))
    assert not compared({NAME: before}, {NAME: recorded()}, with_times=True).faults


def test_more_time_warns_and_fails_only_if_asked() -> None:
    slow = recorded()
    slow = replace(slow, answer=replace(slow.answer, seconds=1.2))
    words = "reduced:1e-2: takes 1.20 times the time"
    assert judged(slow, with_times=False).warnings == [words] and not judged(slow, with_times=False).faults
    assert judged(slow, with_times=True).faults == [words]


@pytest.fixture(scope="module")
def everything() -> list[Case]:
    return golden.all_cases()


@pytest.fixture
def few(everything: list[Case], monkeypatch: pytest.MonkeyPatch) -> list[Case]:
    """Leaves the cases of the first set-up that take milliseconds, and the least of the closed forms."""
    quick = (golden.PAIRS, golden.REDUCED, golden.CLOSED)
    chosen = [each for each in everything if each.method in quick and "parallel-000" in each.name]
    chosen += [each for each in everything if each.name == f"closed forms/one_body 1/{golden.ELEMENTS}"]
    monkeypatch.setattr(golden, "all_cases", lambda: chosen)
    return chosen


def test_all_kinds_of_cases_are_there_with_their_truths(everything: list[Case]) -> None:
    assert len({each.name for each in everything}) == len({each.question for each in everything})
    topics = Counter(each.name.partition("/")[0] for each in everything)
    wanted = {"corrections", "company", "machines", "insulators", "closed forms", "moving"}
    assert topics.keys() == wanted
    assert all(each.truths for each in everything)
    families = {each.name.split("/")[1].rpartition(" ")[0] for each in everything if "machines/" in each.name}
    assert families == set(golden.machines.FAMILIES)


def test_every_option_of_the_command_acts(few: list[Case], tmp_path: Path) -> None:
    old, new = tmp_path / "old.json", tmp_path / "new.json"
    analysis("golden", old)
    document = json.loads(old.read_text())
    assert list(document["cases"]) == [each.name for each in few]
    assert all(each["answer"]["outcome"] == "answered" for each in document["cases"].values())
    assert all(golden.load(old)[each.name].truths == each.truths for each in few)
    assert "The gate passes." in analysis("golden", new, "--against", old, "--only", "closed").stdout
    assert len(json.loads(new.read_text())["cases"]) == 1
    name = next(each.name for each in few if each.method == golden.REDUCED)
    stated = document["cases"][name]["answer"]["values"]["M[sensor, target]"]
    stated["value"] *= 1.05
    new.write_text(json.dumps(document))
    # The old file is read before it is replaced.
    told = analysis("golden", new, "--against", new, status=1).stdout
    assert f"fault: {name}: M[sensor, target]" in told and "The gate fails, faults: 1." in told
    stated["value"] /= 1.05
    # An old time of nothing makes any new one too long.
    for each in document["cases"].values():
        each["answer"]["seconds"] = 1e-9
    old.write_text(json.dumps(document))
    assert "warning" in analysis("golden", new, "--against", old).stdout
    analysis("golden", new, "--against", old, "--times", status=1)
    analysis("golden", new, "--times", status=2)


def refused(*words: str | Path) -> str:
    """The one line on standard error of a command that is refused."""
    (line,) = analysis("golden", *words, status=2).stderr.splitlines()
    return line


def test_what_cannot_be_used_is_refused_in_one_line(few: list[Case], tmp_path: Path) -> None:
    file, other = tmp_path / "golden.json", tmp_path / "other.json"
    other.write_text("")
    assert "cannot be written" in refused(other / "golden.json")
    other.unlink()
    assert "is a folder" in refused(tmp_path)
    assert "no golden file" in refused(file, "--against", other)
    for text in ("", "[]", "{}", '{"format": 1, "cases": []}', '{"format": 1, "cases": {"a": {}}}'):
        other.write_text(text)
        assert "no golden file" in refused(file, "--against", other)
    other.write_text('{"format": 1, "cases": {}}')
    assert "other cases" in refused(file, "--against", other)
    assert "--only" in refused(file, "--only", "nothing of this name")
    assert not file.exists()


def test_an_interrupt_writes_nothing(
    few: list[Case], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    file = tmp_path / "golden.json"
    file.write_text("as it was")
    monkeypatch.setattr(golden, "run_all", interrupted)
    assert "nothing is written" in analysis("golden", file, status=130).stderr
    assert file.read_text() == "as it was" and list(tmp_path.iterdir()) == [file]
