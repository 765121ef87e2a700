"""The field reference: the Maxwell capacitance matrix of a scene by finite elements, with an error for every entry.

`maxwell(scene, rtol=1e-3)` is the library, `python3 -m fem_reference SCENE` the command. The mathematics is in NUMERICS.md
beside this file.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fem_reference.answer.reference import Reference, maxwell

__all__ = ["Reference", "maxwell"]


def __getattr__(name: str) -> Any:
    """Import the solver on first use, so that the command's help and its input errors appear without loading it."""
    if name in __all__:
        import fem_reference.answer.reference as reference

        return getattr(reference, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
