"""Schemas and readers know the same formats: what one refuses, the other does, too."""

import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import tomli_w

import geometries
from geometries.common.errors import InputError
from geometries.common.tables import Table
from geometries.scene import motion, reader
from geometries.studies import families, scene_sweep, schema as study_schema, study
from tests.bad_input import keys
from tests.bad_input.case import Case
from tests.by_night import all_but
from tests.geometries import schemas
from tests.geometries.schemas import MOTION, NAMED, OBJ, SCENE, Document

HERE = Path(geometries.__file__).parent
STUDIES = sorted((HERE / "studies").glob("*.toml"))
MOTIONS = sorted((HERE / "scenes").glob("*.motion.toml"))
SCENES = sorted(set((HERE / "scenes").glob("*.toml")) - set(MOTIONS))
STUDY: Document = {
    "format": 1,
    "name": "gap",
    "title": "Gaps",
    "experiment": "II",
    "reference": {"rtol": 1e-3, "max_seconds": 120, "error": "estimate"},
    "model": {"methods": ["exact"]},
    "sweep": [
        {
            "family": "box",
            "combine": "zip",
            "sensor_size": [0.1, 0.1],
            "target_size": [[0.1, 0.1], [0.05, 0.05]],
            "thickness": 0.01,
            "gap": {"linspace": [0.01, 0.02, 2]},
            "offset": [0.01, 0],
            "material": ["grounded", "floating"],
            "to_ground": 0,
            "machine": "housing",
        },
        {
            "family": "corner",
            "sensor_size": [0.1, 0.1],
            "target_size": [0.1, 0.1],
            "gap": [0.01, 0.02],
            "height": {"geomspace": [0.01, 0.02, 2]},
        },
    ],
}
# The corpus of wrong input does not spoil these keys: its scenes have no format and no mesh file.
MESH = ("object", 15, "shape")
WRONG_SCENES: list[tuple[schemas.Place, Any]] = [
    (("format",), 2),
    (("format",), 0),
    (("sensor", 0, "cover", "relative_permittivity"), 0.5),
    ((*MESH, "scale"), 0),
    ((*MESH, "scale"), "1"),
    ((*MESH, "file"), "body.dae"),
    ((*MESH, "file"), 1),
    ((*MESH, "file"), None),
    ((*MESH, "size"), 1),
]
WRONG_STUDIES: list[tuple[schemas.Place, Any]] = [
    (("name",), "a/b"),
    (("name",), ".."),
    (("experiment",), "VII"),
    (("reference", "rtol"), 0),
    (("reference", "error"), "guess"),
    (("model", "methods"), ["split:4"]),
    (("sweep",), []),
    (("sweep", 0, "family"), "unknown"),
    (("sweep", 0, "combine"), "sum"),
    (("sweep", 0, "thickness"), []),
    (("sweep", 0, "material"), "wood"),
    (("sweep", 0, "machine"), "crane"),
    (("sweep", 1, "material"), "dielectric"),
    (("sweep", 0, "gap"), {"linspace": [0.01, 0.02, 1]}),
    (("sweep", 0, "offset"), {"linspace": [0.01, 0.02, 2]}),
    (("sweep", 1, "height"), {"geomspace": [0, 0.02, 2]}),
    (("sweep", 1, "height"), {"linspace": [0.01, 0.02, 2], "geomspace": [0.01, 0.02, 2]}),
]


@pytest.fixture
def source(tmp_path: Path) -> str:
    """Where a scene is read from: beside the mesh that it names."""
    (tmp_path / "body.obj").write_text(OBJ)
    return str(tmp_path / "scene.toml")


def reads_scene(document: Document, source: str) -> bool:
    return _reads(lambda: reader.loads(tomli_w.dumps(document), source))


def reads_motion(document: Document, source: str) -> bool:
    scene = reader.loads(tomli_w.dumps(SCENE), source)
    return _reads(lambda: motion.loads(tomli_w.dumps(document), scene, source))


def reads_study(document: Document, source: str) -> bool:
    return _reads(lambda: study.loads(tomli_w.dumps(document), source))


def _reads(read: Callable[[], object]) -> bool:
    try:
        read()
    except InputError:
        return False
    return True


FORMATS: dict[str, tuple[Document, Callable[[Document, str], bool]]] = {
    "scene": (SCENE, reads_scene),
    "motion": (MOTION, reads_motion),
    "study": (STUDY, reads_study),
}


@pytest.mark.parametrize("path", [*SCENES, *MOTIONS, *STUDIES], ids=lambda path: path.name)
def test_shipped_files_are_valid(path: Path) -> None:
    kind = "study" if path in STUDIES else "motion" if path in MOTIONS else "scene"
    schemas.validator(kind).validate(tomllib.loads(path.read_text(encoding="utf-8")))


def test_the_examples_of_the_documents_are_valid() -> None:
    blocks = [
        tomllib.loads(block)
        for document in (HERE / "SCENE.md", HERE.parent / "README.md")
        for block in re.findall(r"```toml\n(.*?)```", document.read_text(encoding="utf-8"), re.DOTALL)
    ]
    assert len(blocks) >= 3
    for block in blocks:
        schemas.validator("motion" if "frame" in block else "scene").validate(block)


@pytest.mark.parametrize("name", FORMATS)
def test_a_document_with_every_key_is_valid_and_read(name: str, source: str) -> None:
    document, reads = FORMATS[name]
    schemas.validator(name).validate(document)
    assert reads(document, source)


@pytest.mark.parametrize("name", ["scene", "motion"])
def test_that_document_has_every_key_of_the_schema(name: str) -> None:
    document, _ = FORMATS[name]
    keys = {key for table in schemas.tables(document) for key in schemas.at(document, table)}
    assert keys == _properties(schemas.validator(name).schema)


def _properties(schema: Any) -> set[str]:
    if isinstance(schema, list):
        return set().union(*map(_properties, schema)) if schema else set()
    if not isinstance(schema, dict):
        return set()
    named = set(schema["properties"]) if isinstance(schema.get("properties"), dict) else set()
    return named.union(*map(_properties, schema.values()))


@pytest.mark.parametrize("name", FORMATS)
def test_readers_ask_for_no_key_that_the_schema_does_not_know(
    name: str, source: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: set[str] = set()
    has, value = Table.has, Table.value

    def noted_has(table: Table, key: str) -> bool:
        asked.add(key)
        return has(table, key)

    def noted_value(table: Table, key: str) -> Any:
        asked.add(key)
        return value(table, key)

    monkeypatch.setattr(Table, "has", noted_has)
    monkeypatch.setattr(Table, "value", noted_value)
    document, reads = FORMATS[name]
    assert reads(document, source)
    known = _properties(schemas.validator("scene").schema) | _properties(schemas.validator(name).schema)
    assert asked and asked <= known


@pytest.mark.parametrize("name", ["motion", "study"])
def test_wrong_types_and_unknown_keys_are_refused_by_schema_and_reader(name: str, source: str) -> None:
    document, reads = FORMATS[name]
    validator = schemas.validator(name)
    wrong = [*schemas.with_wrong_types(document), *schemas.with_unknown_keys(document)]
    assert len(wrong) > 10
    for place, changed in wrong:
        assert not validator.is_valid(changed), place
        assert not reads(changed, source), place


@pytest.mark.parametrize("name", ["motion", "study"])
def test_schema_and_reader_agree_on_what_may_be_absent(name: str, source: str) -> None:
    document, reads = FORMATS[name]
    validator = schemas.validator(name)
    verdicts = set()
    for place, changed in schemas.without_keys(document):
        verdicts.add(validator.is_valid(changed))
        assert validator.is_valid(changed) == reads(changed, source), place
    assert verdicts == {True, False}


APART = {case.name for case in keys.related()} | {f"without {'.'.join(map(str, place))}" for place in NAMED}


def is_for_a_schema(case: Case) -> bool:
    """Whether a schema can say it: it knows no numbers that JSON lacks, and not what one table says of another."""
    place, _, wrong = case.name.partition(": ")
    if wrong.endswith("nothing bears"):
        return place.rpartition(".")[2] not in ("parent", "link", "joint", "sense", "drive")
    return not wrong.endswith(("nan", "inf", "64 bits")) and case.name not in APART


@pytest.mark.parametrize("by_night", all_but([False], [False, True]))
def test_the_schema_of_scenes_refuses_every_key_that_the_readers_refuse(
    tmp_path: Path, by_night: bool
) -> None:
    """tests/bad_input shows that both readers refuse what has a place, and read the rest."""
    validator = schemas.validator("scene")
    judged = [case for case in keys.cases() if is_for_a_schema(case) and case.by_night == by_night]
    assert len(judged) > 400
    for case in judged:
        text = case.make(tmp_path).read_text(encoding="utf-8")
        assert validator.is_valid(tomllib.loads(text)) == (case.place is None), case.name


@pytest.mark.parametrize(
    ("name", "place", "value"),
    [*(("scene", *wrong) for wrong in WRONG_SCENES), *(("study", *wrong) for wrong in WRONG_STUDIES)],
    ids=str,
)
def test_values_out_of_range_are_refused_by_schema_and_reader(
    name: str, place: schemas.Place, value: Any, source: str
) -> None:
    document, reads = FORMATS[name]
    wrong = schemas.changed(document, place, value)
    assert not schemas.validator(name).is_valid(wrong)
    assert not reads(wrong, source)


def test_a_scene_of_nothing_is_refused_by_schema_and_reader(source: str) -> None:
    for empty in ({}, {"object": []}, {"link": [{"name": "arm"}]}):
        assert not schemas.validator("scene").is_valid(empty)
        assert not reads_scene(empty, source)


def test_the_schema_of_studies_is_that_of_the_families() -> None:
    assert study_schema.FILE.read_text(encoding="utf-8") == study_schema.text()
    assert {*families.FAMILIES, scene_sweep.FAMILY} == {
        sweep["properties"]["family"]["const"]
        for sweep in study_schema.schema()["properties"]["sweep"]["items"]["oneOf"]
    }


def test_every_schema_is_one_and_is_listed_with_its_version() -> None:
    listed = (schemas.FOLDER / "FORMATS.md").read_text(encoding="utf-8")
    for path in schemas.FOLDER.glob("*.json"):
        name, version = path.name.removesuffix(".schema.json").split("-")
        schema = schemas.validator(name).schema
        assert schema["$id"] == f"urn:fringe:{name}:{version}"
        assert schema["properties"]["format"] == {"const": int(version)}
        assert f"`{name}`" in listed
