"""No workload of the model takes more instructions than recorded; what a difference is, and how to record anew, is told."""

import json
import warnings
from pathlib import Path

import pytest

from tests.by_night import all_but
from tests.model import instruction_counts
from tests.model.instruction_counts import RECORD_COMMAND, CountingFailed, compare


HAS_AVX2 = "avx2" in Path("/proc/cpuinfo").read_text(encoding="utf-8").split()


# By day one workload of each kind is counted, by night all.
BY_DAY = [
    "II_fine/exact",
    "closed_mesh/batch",
    "closed_mesh/exact",
    "closed_mesh/tree:1e-6",
    "scene/capacitance",
    "scene/load",
    "scene/pose",
    "straddling_small/exact",
]


@pytest.mark.skipif(not HAS_AVX2, reason="the recorded counts are those of a processor with AVX2")
@pytest.mark.parametrize("workload", all_but(BY_DAY, instruction_counts.recorded()))
def test_no_workload_takes_more_instructions_than_recorded(workload: str) -> None:
    recorded, counted = instruction_counts.recorded()[workload], instruction_counts.count(workload)
    comparison = compare({workload: recorded}, {workload: counted})
    assert not comparison.failed, str(comparison)
    if comparison.faster:
        warnings.warn(str(comparison), stacklevel=1)


def test_every_workload_is_recorded() -> None:
    assert set(instruction_counts.recorded()) == set(instruction_counts.workloads())


@pytest.mark.night
def test_counts_repeat() -> None:
    """A count is a property of the program, not of the moment: two of the same workload differ by less than one in a thousand."""
    first, second = (instruction_counts.count("I_fine/exact") for _ in range(2))
    assert abs(first - second) < 1e-3 * first


@pytest.mark.parametrize(
    ("counted", "failed", "told"),
    [
        ({"a": 1051, "b": 1049}, True, "a: 1,000 -> 1,051 (+5.1%)"),
        ({"a": 949, "b": 951}, False, "a: 1,000 -> 949 (-5.1%)"),
        ({"b": 1000, "c": 1000}, True, "c: not recorded\n  a: recorded, but"),
        ({"a": 1000, "b": 1000}, False, ""),
    ],
)
def test_differences_of_more_than_five_per_cent_are_told_with_how_to_record(
    counted: dict[str, int], failed: bool, told: str
) -> None:
    """A growth, and another list of workloads, fail; a fall is a hint."""
    comparison = compare({"a": 1000, "b": 1000}, counted)
    assert comparison.failed == failed and told in str(comparison)
    assert "  b: " not in str(comparison) and (RECORD_COMMAND in str(comparison)) == bool(told)


def program(folder: Path, text: str) -> Path:
    path = folder / "program"
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)
    return path


def test_a_program_without_the_counted_function_is_no_fast_one(tmp_path: Path) -> None:
    with pytest.raises(CountingFailed, match="counted nothing"):
        instruction_counts.count("a", Path("/bin/true"))


def test_an_unknown_workload_is_refused() -> None:
    with pytest.raises(CountingFailed, match="no workload is named 'nonsense'"):
        instruction_counts.count("nonsense")


def test_a_failed_recording_leaves_the_old_one(tmp_path: Path) -> None:
    path = tmp_path / "counts.json"
    path.write_text('{"a": 1}')
    lists_then_fails = program(tmp_path, '[ "$1" = --list ] && echo a || exit 1')
    with pytest.raises(CountingFailed):
        instruction_counts.record(path, lists_then_fails)
    assert json.loads(path.read_text()) == {"a": 1}


def test_recording_tells_every_change(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "counts.json"
    path.write_text('{"a": 1000, "gone": 5}')
    monkeypatch.setattr(instruction_counts, "count_all", lambda program: {"a": 2000, "b": 3})
    assert instruction_counts.record(path) == [
        "  a: 1,000 -> 2,000 (+100.0%)",
        "  b: 3, for the first time",
        "  gone: 5, dropped",
    ]
    assert json.loads(path.read_text()) == {"a": 2000, "b": 3}
