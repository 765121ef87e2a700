"""The panel method by itself: its results agree with boundary elements within the error that it states."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.topics.verification.truths import boundary_elements
from tests.fem_reference.panel_method import Plate, maxwell

CASES = {case["name"]: case for case in boundary_elements()}


@pytest.mark.parametrize(
    "name", ["parallel_10x10_gap3", "inclined_hinge1.5_25deg", "corner_0.8_1.2_height1.5"]
)
def test_the_truth_is_within_the_stated_error(name: str) -> None:
    case = CASES[name]
    plates = [
        Plate(*(np.array(plate[key]) for key in ("corner", "edge_u", "edge_v")))
        for plate in case["rectangles"]
    ]
    value, error = maxwell(plates)
    truth = 1e-12 * np.array(case["maxwell_pF"])
    assert np.all(np.abs(value - truth) <= error + case["relative_error"] * np.abs(truth))
    assert np.all(error <= 1e-3 * np.abs(truth))
