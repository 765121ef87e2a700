"""`python3 -m geometries.studies.schema`: writes the JSON schema of study files from the families' parameters."""

from __future__ import annotations

import inspect
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, get_type_hints

from geometries.common.files import whole_file
from geometries.scene.scene import Scene
from geometries.studies import families, machines, scene_sweep, study

FILE = Path(__file__).parent.parent / "schemas" / "study-1.schema.json"
Schema = dict[str, Any]


def schema() -> Schema:
    """Returns the schema of a study as JSON would hold it."""
    method = {"type": "string", "pattern": f"^({study.METHOD_PATTERN})$"}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": "urn:fringe:study:1",
        "title": "A study file, as JSON",
        "type": "object",
        "additionalProperties": False,
        "required": ["name", "title", "reference", "model", "sweep"],
        "properties": {
            "format": {"const": 1},
            "name": {"type": "string", "pattern": "^[^/]+$", "not": {"enum": [".", ".."]}},
            "title": {"type": "string", "minLength": 1},
            "experiment": {"enum": list(study.EXPERIMENTS)},
            "reference": _reference(),
            "model": _table(
                {"methods": {"type": "array", "items": method, "contains": {"const": "exact"}}},
                ["methods"],
            ),
            "sweep": {
                "type": "array",
                "minItems": 1,
                "items": {
                    "oneOf": [
                        *(_sweep(name, family) for name, family in families.FAMILIES.items()),
                        _scene_sweep(),
                    ],
                },
            },
        },
        "$defs": {
            "number": _swept({"type": "number"}, ranges=True),
            "vector": _swept(_array({"type": "number"}, 2), ranges=False),
            "conductor": _swept({"enum": list(families.CONDUCTORS)}, ranges=False),
            "material": _swept({"enum": list(families.MATERIALS)}, ranges=False),
            "machine": _swept({"enum": list(machines.MACHINES)}, ranges=False),
        },
    }


def _table(properties: Schema, required: list[str]) -> Schema:
    return {
        "type": "object",
        "additionalProperties": False,
        "required": required,
        "properties": properties,
    }


def _of_sweeps() -> Schema:
    """Returns the keys of every sweep, whatever its family."""
    rtol = {"type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 1}
    method = {"const": study.BOUNDARY_ELEMENTS}
    return {"reference": _table({"method": method, "rtol": rtol}, ["method", "rtol"])}


def _array(items: Schema, length: int) -> Schema:
    return {"type": "array", "items": items, "minItems": length, "maxItems": length}


def _reference() -> Schema:
    positive = {"type": "number", "exclusiveMinimum": 0}
    asked = {
        "method": {"enum": list(study.REFERENCE_METHODS), "default": study.BOTH},
        "rtol": positive,
        "max_seconds": positive,
        "error": {"enum": list(study.ERROR_KINDS)},
    }
    unasked = {"properties": {"error": {"const": study.NO_REFERENCE}}, "required": ["error"]}
    untimed = {
        "properties": {
            "method": {"const": study.BOUNDARY_ELEMENTS},
            "error": {"not": {"const": "enclosure"}},
        },
        "required": ["method", "rtol"],
    }
    return _table(asked, []) | {"anyOf": [{"required": ["rtol", "max_seconds"]}, unasked, untimed]}


def _swept(value: Schema, ranges: bool) -> Schema:
    """Returns a value, a list of values, or a range."""
    kinds: list[Schema] = [value, {"type": "array", "items": value, "minItems": 1}]
    if ranges:
        count = {"type": "number", "minimum": 2, "multipleOf": 1}
        for name, end in (
            ("linspace", {"type": "number"}),
            ("geomspace", {"type": "number", "exclusiveMinimum": 0}),
        ):
            span = {"type": "array", "prefixItems": [end, end, count], "minItems": 3, "maxItems": 3}
            kinds.append(_table({name: span}, [name]))
    return {"anyOf": kinds}


def _sweep(name: str, family: Callable[..., Scene]) -> Schema:
    parameters = inspect.signature(family).parameters
    # Targets may be dielectric only in families that have a permittivity for them.
    texts = {
        "machine": "machine",
        "material": "material" if "relative_permittivity" in parameters else "conductor",
    }
    hints = get_type_hints(family)
    properties = {
        parameter: {
            "$ref": f"#/$defs/{texts.get(parameter, 'number' if hints[parameter] is float else 'vector')}"
        }
        for parameter in parameters
    }
    required = [
        parameter
        for parameter, described in parameters.items()
        if described.default is inspect.Parameter.empty
    ]
    described = {"family": {"const": name}, "combine": {"enum": ["product", "zip"], "default": "product"}}
    return _table(described | _of_sweeps() | properties, ["family", *required])


def _scene_sweep() -> Schema:
    path = {"type": "string", "minLength": 1}
    described = {"family": {"const": scene_sweep.FAMILY}, "file": path, "motion": path}
    return _table(described | _of_sweeps(), ["family", "file"])


def text() -> str:
    """Returns the schema as its file holds it."""
    return json.dumps(schema(), indent=2) + "\n"


if __name__ == "__main__":
    with whole_file(FILE) as unfinished:
        unfinished.write_text(text(), encoding="utf-8")
