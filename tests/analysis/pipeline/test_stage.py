"""What every stage has in common: an answer is stored whole and once under its key, which changes with all that can change the answer; a failure is told."""

from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from analysis.pipeline import keys
from analysis.pipeline.set_up_stages import SetUpStages
from analysis.pipeline.stage import Finished, NoAnswer, Processes, Refused, Stage, outdated, parsed
from analysis.results import store
from analysis.results.study_results import SCENE, Failure, case_folder
from geometries.common.installation import ROOT
from geometries.scene import writer
from geometries.studies import families, study


def stage(folder: Path, key: str = "key", error: Exception | None = None) -> Stage:
    def answer(_: Processes) -> store.Document:
        if error is not None:
            raise error
        return {"value": 1}

    return Stage("speed", "case", folder / "answer.json", key, 1.0, answer)


def test_an_answer_is_stored_under_its_key_and_not_computed_again(tmp_path: Path) -> None:
    assert stage(tmp_path).run(Processes()) is None
    assert store.read_json(tmp_path / "answer.json") == {"key": "key", "value": 1}
    assert outdated([stage(tmp_path)]) == []


def test_an_outdated_answer_is_removed_with_what_killed_writers_left(tmp_path: Path) -> None:
    stage(tmp_path, "old").run(Processes())
    left, of_another = tmp_path / ".answer.host.1.json", tmp_path / ".another.host.1.json"
    left.touch()
    of_another.touch()
    assert len(outdated([stage(tmp_path)])) == 1
    assert list(tmp_path.iterdir()) == [of_another]


@pytest.mark.parametrize(
    ("error", "refused"), [(NoAnswer, False), (Refused, True), (ValueError, False), (RuntimeError, False)]
)
def test_a_failure_names_case_and_stage_tells_a_refusal_and_stores_nothing(
    tmp_path: Path, error: type[Exception], refused: bool
) -> None:
    failure = stage(tmp_path, error=error("no memory")).run(Processes())
    assert failure == Failure("case", "speed", "no memory", refused)
    assert not list(tmp_path.iterdir())


def test_an_error_of_another_kind_is_not_a_failure_of_the_case(tmp_path: Path) -> None:
    with pytest.raises(ModuleNotFoundError):
        stage(tmp_path, error=ModuleNotFoundError("fringe")).run(Processes())


@pytest.mark.parametrize("text", ["", "{", "[1]", "null"])
def test_what_is_no_json_document_is_no_answer(text: str) -> None:
    with pytest.raises(NoAnswer, match="wrote no JSON document"):
        parsed(text)


@pytest.mark.parametrize(
    ("errors", "reason"),
    [("first\nno memory\n\n", "no memory"), (" \n", "no message"), ("x" * 400, "x" * 300)],
)
def test_the_reason_is_the_last_line_that_a_command_wrote(errors: str, reason: str) -> None:
    assert Finished(2, "", errors).reason == f"exit code 2: {reason}"


STUDY = study.Study("n", "t", 1e-3, 60.0, "estimate", ("exact",), ())
TWO_PLATES = writer.identity(families.parallel((0.1, 0.1), (0.1, 0.1), 0.02))


@pytest.mark.parametrize("content", ["", "{", "[1, 2]"])
def test_a_damaged_document_counts_as_none(tmp_path: Path, content: str) -> None:
    (tmp_path / "a.json").write_text(content)
    assert store.read_json(tmp_path / "a.json") is None


def test_the_reference_key_changes_with_scene_options_and_code() -> None:
    other = writer.identity(families.parallel((0.1, 0.1), (0.1, 0.1), 0.03))
    found = {
        keys.reference_key(TWO_PLATES, STUDY, "a"),
        keys.reference_key(other, STUDY, "a"),
        keys.reference_key(TWO_PLATES, replace(STUDY, rtol=1e-4), "a"),
        keys.reference_key(TWO_PLATES, replace(STUDY, max_seconds=9.0), "a"),
        keys.reference_key(TWO_PLATES, replace(STUDY, error="enclosure"), "a"),
        keys.reference_key(TWO_PLATES, STUDY, "b"),
    }
    assert len(found) == 6
    assert keys.reference_key(TWO_PLATES, replace(STUDY, methods=("split:1",), title="x"), "a") in found


def test_the_model_key_changes_with_methods_and_code_but_not_with_the_reference_options() -> None:
    here = keys.model_key(TWO_PLATES, STUDY, "a")
    assert here != keys.model_key(TWO_PLATES, replace(STUDY, methods=("exact", "split:1")), "a")
    assert here != keys.model_key(TWO_PLATES, STUDY, "b")
    assert here == keys.model_key(TWO_PLATES, replace(STUDY, rtol=1e-4), "a")


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    for name in ("model/src/a.cpp", "fem_reference/solve.py", "geometries/scene/reader.py"):
        store.write_text(tmp_path / name, "first")
    return tmp_path


@pytest.mark.parametrize(
    ("changed", "versions"),
    [
        ("model/src/a.cpp", {"model"}),
        ("model/include/new.hpp", {"model"}),
        ("model/README.md", set()),
        ("fem_reference/solve.py", {"reference"}),
        ("geometries/scene/reader.py", {"reference"}),
        ("geometries/studies/families.py", set()),
        ("analysis/report/page.py", {"report"}),
        ("analysis/report/templates/page.html", {"report"}),
        ("analysis/topics/experiments/section.py", {"report"}),
    ],
)
def test_a_change_of_a_source_changes_the_versions_of_the_code_that_it_is_of(
    repository: Path, changed: str, versions: set[str]
) -> None:
    codes = {"model": keys.model_code, "reference": keys.reference_code, "report": keys.report_code}
    before = {name: code(repository) for name, code in codes.items()}
    store.write_text(repository / changed, "second")
    assert {name for name, code in codes.items() if code(repository) != before[name]} == versions


@dataclass(frozen=True)
class Toy:
    """A set-up whose scene is a number."""

    text: str

    @property
    def identity(self) -> str:
        return f"identity of {self.text}"

    @property
    def id(self) -> str:
        return f"set-up-{self.text}"


class Topic:
    """Stages whose answer is twice the number in the scene, and how often each set-up was answered."""

    def __init__(self, rtol: float = 1e-3) -> None:
        self.answered: Counter[str] = Counter()
        sources = ("analysis/pipeline/set_up_stages.py",)
        self.stages = SetUpStages[Toy]("toys", "toys", rtol, sources, lambda _: 0.1, self._answer)

    def _answer(self, toy: Toy, scene: Path) -> store.Document:
        self.answered[toy.text] += 1
        return {"twice": 2 * int(scene.read_text())}


TOYS = tuple(Toy(text) for text in "1234")


@pytest.fixture
def topic() -> Topic:
    return Topic()


def test_every_set_up_is_answered_once_from_its_scene(topic: Topic, tmp_path: Path) -> None:
    assert topic.stages.run(tmp_path, (*TOYS, TOYS[0]), 2) == []
    found = topic.stages.load(tmp_path, TOYS)
    assert {name: answer["twice"] for name, answer in found.items()} == {t.id: 2 * int(t.text) for t in TOYS}
    assert topic.stages.run(tmp_path, TOYS, 2) == []
    assert topic.answered == Counter("1234")
    assert set(topic.stages.load(tmp_path, TOYS[:2])) == {toy.id for toy in TOYS[:2]}


def test_what_is_broken_gone_or_of_another_version_is_answered_again(topic: Topic, tmp_path: Path) -> None:
    topic.stages.run(tmp_path, TOYS, 2)
    broken, another, gone, _ = (topic.stages.path(tmp_path, toy) for toy in TOYS)
    broken.write_text(broken.read_text()[:20])
    store.write_json(another, (store.read_json(another) or {}) | {"key": "another"})
    gone.unlink()
    left = broken.with_name(".toys.1.2.json")
    left.touch()
    assert set(topic.stages.load(tmp_path, TOYS)) == {TOYS[3].id}
    topic.stages.run(tmp_path, TOYS, 2)
    assert not left.exists()
    assert topic.answered == Counter("1231234")


def test_answers_of_other_code_or_accuracy_are_not_found(
    topic: Topic, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    topic.stages.run(tmp_path, TOYS, 2)
    assert Topic(rtol=1e-2).stages.load(tmp_path, TOYS) == {}
    monkeypatch.setattr(SetUpStages, "code", lambda _: "another")
    assert topic.stages.load(tmp_path, TOYS) == {}


def test_the_code_is_that_of_the_model_and_of_the_topics_sources(topic: Topic, tmp_path: Path) -> None:
    source = tmp_path / topic.stages.sources[0]
    (tmp_path / "model").mkdir()
    source.parent.mkdir(parents=True)
    source.write_text("one")
    (tmp_path / "model" / "integral.cpp").write_text("1")
    first = topic.stages.code(tmp_path)
    source.write_text("two")
    second = topic.stages.code(tmp_path)
    (tmp_path / "model" / "integral.cpp").write_text("2")
    assert len({first, second, topic.stages.code(tmp_path), topic.stages.code(ROOT)}) == 4


def test_a_set_up_without_an_answer_is_told_and_done_the_next_time(topic: Topic, tmp_path: Path) -> None:
    scene = case_folder(tmp_path, TOYS[0].id) / SCENE
    store.write_text(scene, "not a scene")
    (failure,) = topic.stages.run(tmp_path, TOYS, 1)
    assert (failure.case, failure.stage) == (TOYS[0].id, "toys")
    assert set(topic.stages.load(tmp_path, TOYS)) == {toy.id for toy in TOYS[1:]}
    scene.unlink()
    assert topic.stages.run(tmp_path, TOYS, 1) == []
    assert len(topic.stages.load(tmp_path, TOYS)) == len(TOYS)


def test_without_a_folder_there_are_no_answers(topic: Topic, tmp_path: Path) -> None:
    assert topic.stages.load(tmp_path / "nowhere", TOYS) == {}
