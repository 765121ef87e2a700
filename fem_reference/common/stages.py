"""Failures of gmsh and PETSc, with the stage they happened in."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def stage(name: str) -> Iterator[None]:
    """Turn whatever the libraries raise inside into a RuntimeError that names the stage.

    gmsh raises plain Exceptions, PETSc its own RuntimeErrors that are a number only. Running out of memory stays what it is.
    """
    try:
        yield
    except MemoryError:
        raise
    except Exception as failure:
        raise RuntimeError(f"{name} failed: {failure}") from failure
