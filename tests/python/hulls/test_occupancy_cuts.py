"""Laws of the rough hulls that rank cuts: they hold their points, and are nearly the smallest."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from pdoik.occupancy_fit import Halves, clip, half_sum, principal_axes, rough_shapes, smallest_shape

SEED = 20261130


def test_rough_shapes_hold_their_points_and_are_nearly_the_smallest() -> None:
    rng = np.random.default_rng(SEED)
    sizes = rng.uniform(0.02, 0.3, (12, 1, 3))
    sets = sizes * rng.uniform(-1, 1, (12, 40, 3)) + rng.uniform(-1, 1, (12, 1, 3))
    for points, rough in zip(sets, rough_shapes(sets), strict=True):
        assert half_sum(points, rough.focus_a, rough.focus_b).max() < rough.semi_major
        assert rough.volume < 1.1 * smallest_shape(points).volume


def test_of_sets_at_once_each_is_what_it_is_alone() -> None:
    sets = np.random.default_rng(SEED).normal(size=(5, 30, 3))
    together = rough_shapes(sets)
    for points, shape in zip(sets, together, strict=True):
        (alone,) = rough_shapes(points[None])
        assert alone.semi_major == pytest.approx(shape.semi_major, rel=1e-6)


def test_a_sides_points_are_the_farthest_of_the_clipped_surface() -> None:
    rng = np.random.default_rng(SEED)
    triangles = np.asarray(trimesh.creation.torus(0.2, 0.05).triangles)
    halves = Halves(triangles)
    for _ in range(10):
        normal = rng.normal(size=3)
        normal /= np.linalg.norm(normal)
        sides = halves.of(normal, 0.03)
        assert sides is not None
        for side, sign in zip(sides, (1, -1), strict=True):
            clipped = clip(triangles, sign * normal, sign * 0.03).reshape(-1, 3)
            for direction in halves.directions:
                assert (side @ direction).max() == pytest.approx((clipped @ direction).max())
    assert halves.of(np.array([0.0, 0, 1]), 0.05) is None  # it touches
    assert halves.of(np.array([0.0, 0, 1]), 1.0) is None


def test_principal_axes_come_longest_first() -> None:
    rng = np.random.default_rng(SEED)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    points = (rng.normal(size=(1000, 3)) * [0.1, 3.0, 1.0]) @ turn.T + 5.0
    alignment = np.abs(principal_axes(points) @ turn)
    np.testing.assert_allclose(alignment, np.eye(3)[[1, 2, 0]], atol=0.02, rtol=0)
