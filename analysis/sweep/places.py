"""Where a link is at a place between two frames, in words."""

from __future__ import annotations

import math

import numpy as np

from geometries.scene.motion import Frame


def place_words(motion: tuple[Frame, ...], at: float) -> str:
    """Returns the interpolated translation of the link that moves between two frames; empty if several move or one turns.

    `at` counts frames from 1 on.
    """
    number = min(math.floor(at), len(motion) - 1)
    before, after = motion[number - 1].poses, motion[number].poses
    moved = [name for name in before if before[name] != after[name]]
    if len(moved) != 1 or before[moved[0]].rotation != after[moved[0]].rotation:
        return ""
    share = at - number
    first, last = (np.array(poses[moved[0]].translation) for poses in (before, after))
    x, y, z = (1 - share) * first + share * last
    return f"{moved[0]} at ({x:.4g}, {y:.4g}, {z:.4g}) m"
