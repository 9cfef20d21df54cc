"""Clouds of solids: what stays covered, and how much room is won, judged by the solids."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pytest
from scipy.spatial.transform import Rotation

import pdoik

FloatArray = npt.NDArray[np.float64]
LEAF = 0.01
SPACING = LEAF / 3
TURN = Rotation.from_rotvec([0.3, 0.5, 0.2])
AT = np.array([0.5, 0.1, 0.3])
ABOVE = AT + np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Solid:
    """Points of a surface about AT, and the signed distance to it, negative inside [m]."""

    sample: Callable[[float], FloatArray]  # by the distance between neighbours
    distance: Callable[[FloatArray], FloatArray]

    def cloud(self, spacing: float = SPACING) -> FloatArray:
        return TURN.apply(self.sample(spacing)) + AT

    def distance_to(self, points: FloatArray) -> FloatArray:
        return self.distance(TURN.inv().apply(points - AT))

    def sticks_out(self, balls: FloatArray) -> FloatArray:
        """How far each ball stands beyond the surface, (K,)."""
        return self.distance_to(balls[:, :3]) + balls[:, 3]


def line(length: float, spacing: float) -> FloatArray:
    return np.linspace(-length / 2, length / 2, 1 + int(np.ceil(length / spacing)))


def box(*size: float) -> Solid:
    half = np.array(size) / 2

    def sample(spacing: float) -> FloatArray:
        grid = np.stack(np.meshgrid(*(line(s, spacing) for s in size), indexing="ij"), axis=-1)
        points = grid.reshape(-1, 3)
        return points[(np.abs(points) >= half - 1e-9).any(axis=1)]

    return Solid(sample, lambda p: rounded(np.abs(p) - half))


def cylinder(radius: float, length: float) -> Solid:
    def sample(spacing: float) -> FloatArray:
        around = np.linspace(0, 2 * np.pi, int(2 * np.pi * radius / spacing), endpoint=False)
        ring = np.column_stack([np.cos(around), np.sin(around)])
        heights = line(length, spacing)
        side = [np.column_stack([radius * ring, np.full(len(ring), z)]) for z in heights]
        radii = np.arange(0, radius, spacing)
        caps = [
            np.column_stack([r * ring, np.full(len(ring), z)])
            for r in radii
            for z in (-length / 2, length / 2)
        ]
        return np.concatenate(side + caps)

    def distance(p: FloatArray) -> FloatArray:
        aside = np.hypot(p[:, 0], p[:, 1]) - radius
        return rounded(np.column_stack([aside, np.abs(p[:, 2]) - length / 2]))

    return Solid(sample, distance)


def sphere(radius: float) -> Solid:
    def sample(spacing: float) -> FloatArray:
        count = int(4 * np.pi * radius**2 / spacing**2)
        z = 1 - (2 * np.arange(count) + 1) / count
        turned = np.arange(count) * np.pi * (3 - np.sqrt(5))
        aside = np.sqrt(1 - z**2)
        return radius * np.column_stack([aside * np.cos(turned), aside * np.sin(turned), z])

    return Solid(sample, lambda p: np.linalg.norm(p, axis=1) - radius)


def rounded(beyond: FloatArray) -> FloatArray:
    return np.linalg.norm(np.maximum(beyond, 0), axis=1) + np.minimum(beyond.max(axis=1), 0)


def uncovered(points: FloatArray, balls: FloatArray) -> FloatArray:
    """How far each point is outside of all balls, (N,); at most 0 within one."""
    least = np.full(len(points), np.inf)
    for x, y, z, radius in balls:
        least = np.minimum(least, np.linalg.norm(points - (x, y, z), axis=1) - radius)
    return least


SOLIDS = {
    "box": box(0.15, 0.1, 0.08),
    "cylinder": cylinder(0.04, 0.12),
    "sphere": sphere(0.05),
    "board of 2 cm": box(0.2, 0.12, 0.02),
    "board of 1 cm": box(0.2, 0.12, 0.01),
    "sheet of 2 mm": box(0.2, 0.12, 0.002),
}
# How far balls stand out in the mean, at most this share of what those on the surface do.
ROOM = {"box": 0.35, "cylinder": 0.25, "sphere": 0.15, "board of 2 cm": 0.4, "board of 1 cm": 0.9}


@pytest.mark.parametrize("noise", [0.0, 0.001])
@pytest.mark.parametrize("name", SOLIDS)
def test_all_points_stay_covered_and_no_ball_stands_out_farther(name: str, noise: float) -> None:
    solid = SOLIDS[name]
    points = solid.cloud() + np.random.default_rng(0).normal(0, noise, solid.cloud().shape)
    on, sunk = (
        pdoik.voxel_downsample(points, LEAF, radii=True, solid=sink) for sink in (False, True)
    )
    assert len(on) == len(sunk)
    assert uncovered(points, sunk).max() < 1e-9
    before, after = solid.sticks_out(on), solid.sticks_out(sunk)
    assert after.max() <= before.max() + 1e-9
    assert after.mean() <= before.mean() + 1e-9
    if noise == 0.0 and name in ROOM:
        assert after.mean() < ROOM[name] * before.mean()


@pytest.mark.parametrize("name", SOLIDS)
def test_the_true_surface_is_covered_better_than_by_balls_on_it(name: str) -> None:
    solid = SOLIDS[name]
    surface = solid.cloud(SPACING / 2.7)
    on, sunk = (
        pdoik.voxel_downsample(solid.cloud(), LEAF, radii=True, solid=sink)
        for sink in (False, True)
    )
    # Between points neither covers all: those on the surface miss what is beyond their rims.
    assert uncovered(surface, on).max() > 0.5e-3
    assert uncovered(surface, sunk).max() <= uncovered(surface, on).max() + 1e-9
    assert uncovered(surface, sunk).max() < SPACING / np.sqrt(2)


def test_a_sheet_that_is_thinner_than_its_points_are_apart_stays_where_it_is() -> None:
    points = SOLIDS["sheet of 2 mm"].cloud()
    on, sunk = (
        pdoik.voxel_downsample(points, LEAF, radii=True, solid=sink) for sink in (False, True)
    )
    np.testing.assert_array_equal(sunk, on)


def test_a_sheet_seen_from_both_sides_stays_where_it_is() -> None:
    points = SOLIDS["sheet of 2 mm"].cloud()
    above = (TURN.inv().apply(points - AT)[:, 2:] > 0) * 2.0 - 1.0
    views = AT + TURN.apply(above * [0.0, 0.0, 1.0])
    on = pdoik.voxel_downsample(points, LEAF, radii=True)
    sunk = pdoik.voxel_downsample(points, LEAF, solid=True, viewpoint=views)
    np.testing.assert_array_equal(sunk, on)
    # The same points from one side are taken for the face of something solid.
    one = pdoik.voxel_downsample(points, LEAF, solid=True, viewpoint=views[above[:, 0] > 0][0])
    assert (one[:, 3] > 1.5 * on[:, 3].max()).mean() > 0.5
    assert uncovered(points, one).max() < 1e-9


@pytest.mark.parametrize("name", ["box", "cylinder", "sphere"])
def test_a_depth_camera_sees_solids_from_its_side(name: str) -> None:
    solid, camera = SOLIDS[name], np.array([1.2, 0.4, 0.9])
    points = solid.cloud()
    step = 1e-4 * (camera - points) / np.linalg.norm(camera - points, axis=1, keepdims=True)
    points = points[solid.distance_to(points + 20 * step) > 0]  # facing it: what is convex shows
    on = pdoik.voxel_downsample(points, LEAF, radii=True)
    sunk = pdoik.voxel_downsample(points, LEAF, solid=True, viewpoint=camera)
    assert uncovered(points, sunk).max() < 1e-9
    before, after = solid.sticks_out(on), solid.sticks_out(sunk)
    assert np.median(after) < 0.4 * np.median(before)
    assert after.mean() < 0.8 * before.mean()
    assert (after > before.max() + 1e-9).mean() < 0.05
    # An open cloud encloses nothing: without the camera's place all stays.
    np.testing.assert_array_equal(pdoik.voxel_downsample(points, LEAF, solid=True), on)


@pytest.mark.parametrize("count", [0, 1, 2, 3])
def test_points_too_few_for_a_normal_stay_where_they_are(count: int) -> None:
    points = np.array([[0.502, 0, 0], [0.505, 0, 0], [0.508, 0.001, 0]])[:count]
    on = pdoik.voxel_downsample(points, LEAF, radii=True)
    np.testing.assert_array_equal(pdoik.voxel_downsample(points, LEAF, solid=True), on)
    if count:
        sunk = pdoik.voxel_downsample(points, LEAF, solid=True, viewpoint=[0.5, 0, 1.0])
        assert uncovered(points, sunk).max() < 1e-9
        if count < 3:
            np.testing.assert_array_equal(sunk, on)


def test_rows_that_are_not_finite_change_nothing() -> None:
    points = SOLIDS["box"].cloud()
    holes = np.insert(points, np.arange(0, len(points), 50), np.nan, axis=0)
    np.testing.assert_array_equal(
        pdoik.voxel_downsample(holes, LEAF, solid=True),
        pdoik.voxel_downsample(points, LEAF, solid=True),
    )


def test_a_solid_cloud_is_replaced_as_a_whole_or_not_at_all() -> None:
    points = SOLIDS["box"].cloud()
    rows = pdoik.voxel_downsample(points, LEAF, solid=True)
    cloud = pdoik.Cloud(points, leaf=LEAF, solid=True)
    np.testing.assert_allclose(cloud.points[np.argsort(cloud.ids)], rows, atol=1e-6)
    # Centres lie elsewhere than their points: a part would take balls of points that stay.
    part, whole = np.array([AT - [1, 1, 0.01], AT + 1]), np.array([AT - 1, AT + 1])
    for change in (
        lambda: cloud.update(points[points[:, 2] >= part[0, 2]], part),
        lambda: cloud.remove(part),
    ):
        with pytest.raises(ValueError, match="a solid cloud, which is changed as a whole"):
            change()
    assert len(cloud) == len(rows)
    assert cloud.update(points, whole, viewpoint=ABOVE) == len(rows)
    assert len(cloud) == len(rows)
    assert uncovered(points, cloud.points).max() < 1e-6
    assert cloud.remove(whole) == len(rows)
    # Nothing sinks out of the region that is to be filled.
    assert cloud.update(points[points[:, 2] >= part[0, 2]], part, viewpoint=ABOVE) == 0
    assert cloud.points[:, 2].min() >= part[0, 2] - 1e-6
    assert (cloud.points[:, 3] > LEAF).any()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"solid": True, "viewpoint": [0.0, np.nan, 1.0]}, "viewpoints holds NaN"),
        ({"solid": True, "viewpoint": [0.0, 1.0]}, r"viewpoint has shape \(2,\)"),
        ({"solid": True, "viewpoint": np.zeros((3, 3))}, "viewpoints has 3 rows"),
        ({"solid": False, "viewpoint": [0.0, 0.0, 1.0]}, "solid is False"),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(arguments: dict[str, object], words: str) -> None:
    points = SOLIDS["sphere"].cloud()
    with pytest.raises(ValueError, match=words):
        pdoik.voxel_downsample(points, LEAF, **arguments)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=words):
        pdoik.Cloud(points, leaf=LEAF, **arguments)  # type: ignore[arg-type]


def test_a_solid_cloud_needs_a_leaf() -> None:
    with pytest.raises(ValueError, match="there is no leaf"):
        pdoik.Cloud(np.zeros((3, 3)), solid=True)
    with pytest.raises(ValueError, match="solid is False"):
        pdoik.Cloud(np.zeros((3, 3)), viewpoint=[0, 0, 1])


def test_solves_among_sunk_clouds_are_clear_of_the_true_shapes() -> None:
    robot = pdoik.Robot.builtin("panda")
    rng = np.random.default_rng(3)
    solver = pdoik.Solver(robot, pdoik.Options(max_time=10.0, max_restarts=30))
    solved = 0
    for _ in range(20):
        T = np.eye(4)
        T[:3, :3] = Rotation.random(random_state=rng).as_matrix()
        T[:3, 3] = rng.uniform([0.3, -0.4, 0.2], [0.6, 0.4, 0.7])
        true = pdoik.Shape.box("box", [0.15, 0.1, 0.08], T)
        points = SOLIDS["box"].sample(SPACING) @ T[:3, :3].T + T[:3, 3]
        cloud = pdoik.Cloud(points, leaf=LEAF, solid=True)
        target = robot.fk(rng.uniform(robot.lower, robot.upper))
        result = solver.solve(target, obstacles=cloud)
        if not result.success:
            continue
        solved += 1
        # Between points there is surface up to 2.4 mm from the nearest: the balls miss some of it.
        verdict = solver.judge(target, result.q, obstacles=[true])
        assert verdict.clearance > -0.5e-3
    assert solved >= 15
