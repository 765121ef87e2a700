"""Made-up answers as the programs print them. What stands in for the field solver takes them from here in every process of its own,
so that nothing is imported that takes long to load."""

from typing import Any

VERSIONS = {"dolfinx": "0.5.2"}
PICO = 1e-12


def reference_document(mutual: float, delta_self: float, error: float = 0.01, **more: Any) -> dict[str, Any]:
    """The reference's answer for two conductors, in pF: M[s,s] is 4 + delta_self, that of the sensor alone being 4."""
    own = (4 + delta_self) * PICO
    matrix = [[own, -mutual * PICO], [-mutual * PICO, own]]
    coarse = [[1.1 * value for value in row] for row in matrix]
    return {
        "conductors": ["sensor", "target"],
        "maxwell": matrix,
        "error": [[error * PICO] * 2] * 2,
        "delta_self": {"sensor": {"value": delta_self * PICO, "error": error * PICO}},
        "levels": [
            {"h_min": 1e-3, "unknowns": 1000, "cells": 300, "seconds": 1.5, "maxwell": coarse},
            {"h_min": 5e-4, "unknowns": 2000, "cells": 600, "seconds": 3.0, "maxwell": matrix},
        ],
        "unknowns": 2000,
        "seconds": 4.5,
        "reached": True,
        "method": "made up",
        "error_kind": "estimate",
        "versions": VERSIONS,
    } | more


def boundary_document(mutual: float, delta_self: float, error: float = 0.001, **more: Any) -> dict[str, Any]:
    """The boundary elements' answer for the same two conductors, in pF."""
    whole = reference_document(mutual, delta_self, error)
    names = ("conductors", "maxwell", "error", "delta_self", "unknowns", "seconds", "reached")
    return {name: whole[name] for name in names} | {"lower_bounds": [True, True], "rtol": 1e-4} | more


def empty_document() -> dict[str, Any]:
    """The reference's answer for the sensor alone: 4 pF."""
    whole = reference_document(1, 0)
    return whole | {
        "conductors": ["sensor"],
        "maxwell": [[4 * PICO]],
        "error": [[0.01 * PICO]],
        "delta_self": {},
        "levels": [],
    }


def model_document(exact: float, coarse: float | None = None) -> dict[str, Any]:
    """The model's answers in pF: exact and split:4 nearly the same, split:0 as given."""
    values = {"exact": exact, "split:0": exact if coarse is None else coarse, "split:4": exact * (1 + 1e-5)}
    seconds = {"exact": 1e-6, "split:0": 5e-7, "split:4": 4e-5}
    return {
        "key": "",
        "version": "0.1.0",
        "methods": {
            method: {
                "seconds": seconds[method],
                "sensors": [
                    {
                        "name": "sensor",
                        "total": value * PICO,
                        "objects": [{"name": "target", "capacitance": value * PICO}],
                    }
                ],
            }
            for method, value in values.items()
        },
    }
