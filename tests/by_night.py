"""Statistics of which a few values are tried by every check, and all by night."""

from collections.abc import Iterable, Sequence
from typing import Any

import pytest


def all_but(by_day: Sequence[Any], values: Iterable[Any]) -> list[Any]:
    """Returns the values for `pytest.mark.parametrize`; those that are not in `by_day` have the marker night."""
    return [value if value in by_day else pytest.param(value, marks=pytest.mark.night) for value in values]
