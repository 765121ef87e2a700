"""Gaps that are left out of the size of the cells are those that set it nowhere."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from fem_reference.bodies.distances import distance
from fem_reference.bodies.shapes import Cuboid, Rectangle
from fem_reference.mesh.body_distances import edge_distance, surface_distance
from fem_reference.mesh.size_rules import Sizing
from fem_reference.mesh.sizing import _in_gap, _is_wide


def test_in_a_wide_gap_the_growth_from_edges_is_smaller_everywhere() -> None:
    random = np.random.default_rng(1)
    sizing, left_out = Sizing(growth=0.6), 0
    for _ in range(200):
        axes = Rotation.random(2, random_state=int(random.integers(1 << 30))).as_matrix()
        body: Rectangle | Cuboid = Cuboid("body", np.zeros(3), axes[0], tuple(random.uniform(0.1, 1, 3)))
        if random.random() < 0.5:
            body = Rectangle("body", np.zeros(3), axes[0], tuple(random.uniform(0.1, 1, 2)))
        other = Cuboid("other", random.uniform(-4, 4, 3), axes[1], (0.3, 0.5, 0.2))
        ratio = _in_gap(body, other, sizing)
        if not _is_wide(body, distance(body, other), ratio, sizing):
            continue
        left_out += 1
        points = np.concatenate([random.uniform(-5, 5, (500, 3)), random.normal(size=(500, 3))])
        edges = edge_distance(body, points.T)
        assert edges is not None
        grown = sizing.edge * body.size + sizing.growth * edges
        in_gap = ratio * (surface_distance(body, points.T) + surface_distance(other, points.T))
        assert np.all(grown <= in_gap)
    assert left_out > 50
