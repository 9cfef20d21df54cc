"""The voxel filter gives the mean of each occupied cell, as NumPy does."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pdoik
from references import voxel_means


def points_off_the_walls(
    rng: np.random.Generator, count: int, leaf: float, cells: int
) -> np.ndarray:
    """Points whose cell float32 gets right."""
    corner = rng.integers(-cells, cells, (count, 3))
    return leaf * (corner + rng.uniform(0.01, 0.99, (count, 3)))


def sort_rows(points: np.ndarray) -> np.ndarray:
    return points[np.lexsort(np.round(points, 4).T)]


@given(
    seed=st.integers(0, 2**32),
    count=st.integers(1, 300),
    leaf=st.sampled_from([0.01, 0.05, 0.1, 0.37, 2.0]),
    cells=st.integers(1, 6),
)
def test_each_occupied_cell_gives_its_mean(seed: int, count: int, leaf: float, cells: int) -> None:
    points = points_off_the_walls(np.random.default_rng(seed), count, leaf, cells)
    means = voxel_means(points, leaf)
    cloud = pdoik.voxel_downsample(points, leaf)
    assert cloud.shape == means.shape
    tolerance = 2e-6 * np.abs(points).max()
    distances = np.linalg.norm(cloud[:, None] - means[None], axis=2)
    assert distances.min(axis=0).max() <= tolerance
    assert distances.min(axis=1).max() <= tolerance


def test_lists_float32_strided_and_fortran_arrays_give_the_same_cloud(
    rng: np.random.Generator,
) -> None:
    points = points_off_the_walls(rng, 200, 0.1, 5).astype(np.float32).astype(np.float64)
    wide = np.zeros((400, 6))
    wide[::2, 1::2] = points
    expected = pdoik.voxel_downsample(points, 0.1)
    for same in (
        points.tolist(),
        points.astype(np.float32),
        wide[::2, 1::2],
        np.asfortranarray(points),
        points.astype(">f8"),
    ):
        np.testing.assert_array_equal(pdoik.voxel_downsample(same, 0.1), expected)


def test_rows_that_are_not_finite_are_left_out(rng: np.random.Generator) -> None:
    points = points_off_the_walls(rng, 100, 0.1, 3)
    holes = np.repeat(points, 2, axis=0)
    holes[1::2, rng.integers(0, 3)] = rng.choice([np.nan, np.inf, -np.inf], 100)
    np.testing.assert_array_equal(
        pdoik.voxel_downsample(holes, 0.1), pdoik.voxel_downsample(points, 0.1)
    )


@pytest.mark.parametrize("empty", [[], np.zeros((0, 3)), np.full((4, 3), np.nan)])
def test_nothing_in_gives_nothing_out(empty: np.ndarray) -> None:
    assert pdoik.voxel_downsample(empty, 0.1).shape == (0, 3)


def test_the_cloud_is_not_changed(rng: np.random.Generator) -> None:
    points = rng.uniform(-1, 1, (50, 3))
    before = points.copy()
    points.flags.writeable = False
    pdoik.voxel_downsample(points, 0.1)
    np.testing.assert_array_equal(points, before)


@pytest.mark.parametrize("leaf", [0.0, -0.1, np.nan, np.inf])
def test_a_leaf_that_is_no_length_is_refused(leaf: float) -> None:
    with pytest.raises(ValueError, match="leaf is"):
        pdoik.voxel_downsample(np.zeros((1, 3)), leaf)


def test_a_leaf_too_small_for_the_cloud_is_refused_rather_than_the_cloud_returned_unfiltered() -> (
    None
):
    with pytest.raises(ValueError, match=r"leaf is .* too small"):
        pdoik.voxel_downsample([[0, 0, 0], [10, 10, 10]], 1e-4)


@pytest.mark.parametrize("shape", [(3,), (2, 2), (2, 4), (2, 3, 5), ()])
def test_a_cloud_of_another_shape_is_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match="points has shape"):
        pdoik.voxel_downsample(np.ones(shape), 0.1)


@given(seed=st.integers(0, 2**32), leaf=st.sampled_from([0.01, 0.05, 0.1, 0.37]))
def test_balls_of_the_covering_radii_hold_the_whole_cloud(seed: int, leaf: float) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(0, rng.choice([0.02, 0.2, 1.0]), (rng.integers(1, 2000), 3))
    points[rng.uniform(size=len(points)) < 0.05] = np.nan
    balls = pdoik.voxel_downsample(points, leaf, radii=True)
    np.testing.assert_array_equal(balls[:, :3], pdoik.voxel_downsample(points, leaf))
    points = points[np.isfinite(points).all(axis=1)]
    if len(points) == 0:
        assert balls.shape == (0, 4)
        return
    distances = np.linalg.norm(points[:, None] - balls[None, :, :3], axis=2)
    nearest = distances.argmin(axis=1)
    assert (distances <= balls[None, :, 3] + 1e-12).any(axis=1).all()
    # No larger than needed: each ball ends at a point that has no nearer centre.
    expected = np.zeros(len(balls))
    np.maximum.at(expected, nearest, distances.min(axis=1))
    np.testing.assert_allclose(balls[:, 3], expected, atol=1e-12)
    assert balls[:, 3].max() <= np.sqrt(3) * leaf


def test_a_cloud_without_points_has_no_balls() -> None:
    assert pdoik.voxel_downsample(np.empty((0, 3)), 0.1, radii=True).shape == (0, 4)
