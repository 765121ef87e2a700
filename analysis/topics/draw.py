"""Draws what set-ups are made of at random. Python promises that the numbers of a generator stay the same."""

import math
import random

from geometries.scene.poses import QuaternionRotation

Range = tuple[float, float]

DIGITS = 4
"""Decimals of a length: a tenth of a millimetre."""


def length(chance: random.Random, ends: Range) -> float:
    """Draws a length (m) uniformly in its logarithm, so that small and large ones are equally frequent."""
    return round(logarithmic(chance, ends), DIGITS)


def logarithmic(chance: random.Random, ends: Range) -> float:
    """Draws a number uniformly in its logarithm."""
    return math.exp(chance.uniform(math.log(ends[0]), math.log(ends[1])))


def between(chance: random.Random, ends: Range) -> float:
    """Draws a length (m) uniformly."""
    return round(chance.uniform(*ends), DIGITS)


def rotation(chance: random.Random) -> QuaternionRotation:
    """Draws a rotation uniformly from all rotations (K. Shoemake, Graphics Gems III (1992) 124)."""
    u, first, second = chance.random(), 2 * math.pi * chance.random(), 2 * math.pi * chance.random()
    a, b = math.sqrt(1 - u), math.sqrt(u)
    numbers = a * math.sin(first), a * math.cos(first), b * math.sin(second), b * math.cos(second)
    return QuaternionRotation(numbers)
