"""geometries/STUDY.md: its example can be read, and its tables list every key of the schema with its default."""

from __future__ import annotations

import inspect
import re
from pathlib import Path

import pytest

from geometries.studies import families, schema, study

PAGE = (Path(study.__file__).parents[1] / "STUDY.md").read_text(encoding="utf-8")
REQUIRED = "must be given"


def table_after(heading: str, first: str) -> list[list[str]]:
    """The rows of the first table after a heading whose first column has this title."""
    text = PAGE.split(f"{heading}\n", 1)[1].split(f"| {first} |", 1)[1].split("\n\n", 1)[0]
    return [[cell.strip() for cell in line.strip("| ").split(" | ")] for line in text.splitlines()[2:]]


def parameters() -> dict[tuple[str, str], str]:
    """The default of each parameter of each family, as the page has it."""
    every, found, name = [*families.FAMILIES], {}, ""
    for line in PAGE.split("| parameter |", 1)[1].split("\n\n", 1)[0].splitlines()[2:]:
        first, where, _, default, _ = (cell.strip() for cell in line.split("|")[1:6])
        name = first.strip("`") or name
        chosen = every if where.startswith("all but") else re.findall(r"`(\w+)`", where)
        found |= {(family, name): default for family in chosen}
    return found


def test_the_example_is_a_study() -> None:
    example = re.search(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    assert example is not None
    read = study.loads(example[1])
    assert read.reference_method == study.BOTH and len(read.sweeps) == 5 * 2 * 5 + 1


def test_every_parameter_of_every_family_is_there_with_its_default() -> None:
    shown = parameters()
    known = {
        (family, name): parameter.default
        for family, function in families.FAMILIES.items()
        for name, parameter in inspect.signature(function).parameters.items()
    }
    assert {key for key in shown if key[0] != "scene"} == set(known)
    assert {name for family, name in shown if family == "scene"} == {"file", "motion"}
    for key, default in known.items():
        if default is inspect.Parameter.empty:
            assert shown[key] == REQUIRED, key
        else:
            text = str(list(default)).replace(".0", "") if isinstance(default, tuple) else default
            number = f"{text:g}" if isinstance(text, float) else text
            quoted = f'"{number}"' if isinstance(default, str) else number
            assert shown[key] == f"`{quoted}`", key


@pytest.mark.parametrize(("heading", "keys"), [("## The file", None), ("## `[reference]`", "reference")])
def test_every_key_of_the_schema_is_there(heading: str, keys: str | None) -> None:
    properties = schema.schema()["properties"]
    known = set(properties[keys]["properties"] if keys else properties) - {"reference", "model", "sweep"}
    assert {row[0].strip("`") for row in table_after(heading, "key")} == known


def test_every_family_and_every_form_of_a_method_are_there() -> None:
    names = {row[0].strip("`") for row in table_after("## `[[sweep]]`", "family")}
    assert names == {*families.FAMILIES, "scene"}
    forms = re.findall(r'"([\w:+-]+)"', study.METHODS)
    listed = PAGE.split("## `[model]`")[1].split("## `[[sweep]]`")[0]
    assert forms and all(form in listed for form in forms)
