"""Values of options: numbers that make sense, and a reason for all others."""

from __future__ import annotations

import argparse

import pytest

from geometries.common.arguments import positive_integer, positive_number


def test_positive_numbers_are_read() -> None:
    assert positive_number("2.5e-3") == 2.5e-3
    assert positive_integer("12") == 12


@pytest.mark.parametrize("text", ["0", "-1", "nan", "inf", "much", ""])
def test_other_numbers_are_refused(text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError, match=f"'{text}' is not a finite number greater than 0"):
        positive_number(text)


@pytest.mark.parametrize("text", ["0", "-1", "1.5", "many"])
def test_other_counts_are_refused(text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError, match=f"'{text}' is not a whole number greater than 0"):
        positive_integer(text)
