"""Answers of a topic's quick set-ups, computed once for the tests of a file, which names its `TOPIC` and returns these set-ups from `some`."""

from pathlib import Path
from typing import Any

import pytest


@pytest.fixture(scope="module")
def folder(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    topic = request.module.TOPIC
    place = tmp_path_factory.mktemp("results") / topic.name
    assert topic.stages.run(place, request.module.some(), 2) == []
    return place


@pytest.fixture(scope="module")
def found(request: pytest.FixtureRequest, folder: Path) -> list[Any]:
    """The entries of the set-ups, in their order."""
    topic, some = request.module.TOPIC, request.module.some()
    answers = topic.stages.load(folder, some)
    return [topic.entry(each, answers[each.id]) for each in some]
