"""Names the stage in which gmsh or PETSc failed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def stage(name: str) -> Iterator[None]:
    """Convert exceptions of the libraries into a RuntimeError that names the stage.

    gmsh raises plain Exceptions, and PETSc RuntimeErrors that contain only a number. A MemoryError is not converted.
    """
    try:
        yield
    except MemoryError:
        raise
    except Exception as failure:
        raise RuntimeError(f"{name} failed: {failure}") from failure
