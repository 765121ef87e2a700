"""What the set-ups of all topics have in common: each is answered once, what is outdated again, and a failure is told."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from analysis.pipeline.set_up_stages import SetUpStages
from analysis.results import store
from analysis.results.study_results import SCENE, case_folder
from geometries.common.installation import ROOT


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


@dataclass
class Topic:
    """Stages whose answer is twice the number in the scene, and how often each set-up was answered."""

    answered: Counter[str] = field(default_factory=Counter)

    @property
    def stages(self) -> SetUpStages[Toy]:
        return SetUpStages[Toy](
            name="toys",
            what="toys",
            rtol=1e-3,
            sources=("analysis/pipeline/set_up_stages.py",),
            seconds=lambda _: 0.1,
            answer=self._answer,
        )

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
    assert {name: answer["twice"] for name, answer in found.items()} == {
        toy.id: 2 * int(toy.text) for toy in TOYS
    }
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
    coarser = SetUpStages[Toy](
        "toys", "toys", 1e-2, topic.stages.sources, topic.stages.seconds, topic.stages.answer
    )
    assert coarser.load(tmp_path, TOYS) == {}
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
