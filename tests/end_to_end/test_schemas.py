"""What the programs print is what the schemas say."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from analysis.pipeline import model_stage
from fem_reference import __main__ as fem_reference
from tests.geometries import schemas
from tests.geometries.schemas import PLATE, Document
from tests.programs import fringe_command, in_this_process

TWO_PLATES: Document = {
    "sensor": [{"name": "front", "plates": [PLATE]}],
    "distance_sensor": [
        {"name": name, "apex": [0.05, 0.05, 0], "direction": [0, 0, z], "full_angle_degrees": 40, "range": 1}
        for name, z in (("eye", 1), ("blind", -1))
    ],
    "object": [
        {"name": "hand", "shape": {"type": "plate", "size": [0.1, 0.1]}, "translation": [0, 0, 0.05]},
        {"name": "cube", "shape": {"type": "cube", "size": 0.05}, "translation": [0, 0, 0.2]},
    ],
}
SCENE = tomli_w.dumps(TWO_PLATES)
COMMANDS = {
    "capacitance": [
        ["capacitance"],
        ["capacitance", "--method", "split:2+nearest"],
        ["capacitance", "--method", "formula"],
    ],
    "maxwell": [
        ["capacitance", "--method", "boundary-elements", "--rtol", "0.01"],
        ["capacitance", "--method", "reduced", "--entries"],
        ["capacitance", "--method", "auto", "--entries"],
    ],
    "collide": [["collide"]],
    "info": [["info"]],
    "sense": [["sense"]],
}

OPTIONAL = ("lower", "upper", "entries")  # of readings, where a bound is proven; where it is asked for


def printed(*words: str | Path) -> Document:
    document: Document = json.loads(fringe_command(*words).stdout)
    return document


every_answer = pytest.mark.parametrize(
    ("name", "options"), [(name, options) for name, all_ in COMMANDS.items() for options in all_], ids=str
)


@every_answer
def test_the_command_prints_what_the_schema_says_and_the_module_returns(
    name: str, options: list[str], scene: Path
) -> None:
    """The schema describes every key of every table, and requires it."""
    command, *texts = options
    document = printed(command, scene, "--json", *texts)
    validator = schemas.validator(name)
    validator.validate(document)
    for place, changed in [*schemas.with_unknown_keys(document), *schemas.without_keys(document)]:
        assert validator.is_valid(changed) == (place[-1] in OPTIONAL), place
    values: dict[str, Any] = {"entries": True} if "--entries" in texts else {}
    for option, number in (("--method", str), ("--rtol", float)):
        if option in texts:
            values[option.removeprefix("--")] = number(texts[texts.index(option) + 1])
    returned = getattr(model_stage.model_module().Scene.load(scene), command)(**values)
    assert list(document) == ["format", *returned]
    parsed = json.loads(json.dumps(returned, default=np.ndarray.tolist))
    assert without_time(parsed) == without_time(document)


def without_time(answer: Document) -> Document:
    return {
        key: value for key, value in answer.items() if key not in ("format", "seconds", "expected_seconds")
    }


def test_infinite_capacitances_at_a_contact_are_numbers_to_the_schema(scene: Path) -> None:
    scene.write_text(
        tomli_w.dumps(schemas.changed(TWO_PLATES, ("object", 0, "translation"), [0.05, 0.05, 0]))
    )
    document = printed("capacitance", scene, "--json")
    assert document["sensors"][0]["contact"]
    schemas.validator("capacitance").validate(document)


def test_the_reference_prints_what_the_schema_says(scene: Path) -> None:
    """Alone and with proven intervals; with objects, and stored, its answers are those that test_run_script.py tries."""
    scene.write_text(tomli_w.dumps({"sensor": TWO_PLATES["sensor"]}))
    done = in_this_process(fem_reference.main, scene, "--rtol", 0.1, "--max-unknowns", 1000, "--json")
    schemas.validator("reference").validate(json.loads(done.stdout))
