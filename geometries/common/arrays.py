"""The types of numpy arrays, by what they hold."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.int64]
Integers = NDArray[np.int32]
"""Numbers of the nodes, faces and cells of a mesh, as its libraries have them."""
