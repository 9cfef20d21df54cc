"""Pictures: real PNG files that show what there is to show."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

import pdoik
from pdoik._hulls import PlacedCapsule, gaps, placed_hulls, skeleton, wide_hulls
from pdoik.picture import FacetSoup, best_azimuth, draw_solution, spheroid_axes
from samples import with_capsules, with_hulls

NAMES = ("panda", "ur10", "iiwa14")


def solved(name: str = "panda", **options: float) -> tuple[pdoik.Solver, pdoik.Result, np.ndarray]:
    robot = with_hulls(pdoik.Robot.builtin(name))
    solver = pdoik.Solver(robot, pdoik.Options(max_time=1.0, **options))
    T_base_tip = robot.fk(robot.mid_configuration() + 0.3)
    return solver, solver.solve(T_base_tip), T_base_tip


def pixels(path: Path) -> np.ndarray:
    assert path.read_bytes().startswith(b"\x89PNG\r\n\x1a\n")
    return imread(path)[:, :, :3]


def is_like(image: np.ndarray, rgb: tuple[float, float, float], within: float = 0.12) -> int:
    return int((np.abs(image - np.array(rgb)).max(axis=2) < within).sum())


@pytest.mark.parametrize("name", NAMES)
def test_a_picture_shows_arm_hulls_points_and_frames(tmp_path: Path, name: str) -> None:
    solver, result, T_base_tip = solved(name)
    rng = np.random.default_rng(0)
    surface = rng.uniform([0.3, -0.5, 0.7], [0.6, 0.5, 1.0], (5000, 3))
    path = tmp_path / "picture.png"
    cloud = pdoik.voxel_downsample(surface, 0.1)
    draw_solution(path, solver, result, T_base_tip, cloud, surface=surface)
    image = pixels(path)
    assert min(image.shape[:2]) > 800
    white = is_like(image, (1, 1, 1), 0.02) / image[:, :, 0].size
    assert 0.2 < white < 0.9
    for color in ((0.16, 0.18, 0.21), (0.55, 0.68, 0.82), (0.13, 0.36, 0.80), (0.75, 0.13, 0.13)):
        assert is_like(image, color) > 50, color
    assert [entry.name for entry in tmp_path.iterdir()] == ["picture.png"]


def test_many_points_are_dots_coloured_by_their_gap(tmp_path: Path) -> None:
    solver, result, T_base_tip = solved()
    tip = solver.robot.fk(result.q)[:3, 3]
    near = tip + np.random.default_rng(0).uniform(-0.05, 0.05, (4000, 3))
    draw_solution(tmp_path / "few.png", solver, result, T_base_tip, near[:1])
    draw_solution(tmp_path / "dots.png", solver, result, T_base_tip, near)
    red = [is_like(pixels(tmp_path / name), (0.83, 0.08, 0.11)) for name in ("few.png", "dots.png")]
    assert red[1] > 2 * red[0]


def test_a_failure_is_drawn_as_one(tmp_path: Path) -> None:
    solver, _, T_base_tip = solved()
    T_base_tip[:3, 3] = (3.0, 0.0, 0.5)
    result = solver.solve(T_base_tip)
    assert not result.success
    path = tmp_path / "failure.png"
    draw_solution(path, solver, result, T_base_tip)
    headline = pixels(path)[:60]
    assert is_like(headline, (0.70, 0.15, 0.12)) > 100


def test_a_robot_without_hulls_can_be_drawn(tmp_path: Path) -> None:
    solver, result, _ = solved()
    robot = solver.robot
    robot.occupancy = pdoik.Occupancy()
    draw_solution(tmp_path / "bare.png", pdoik.Solver(robot), result, None, np.ones((4, 3)))
    assert is_like(pixels(tmp_path / "bare.png"), (0.16, 0.18, 0.21)) > 50


def test_an_old_picture_survives_a_failure_to_draw(tmp_path: Path) -> None:
    solver, result, T_base_tip = solved()
    path = tmp_path / "old.png"
    path.write_bytes(b"old")
    with pytest.raises(ValueError, match=r"\(4, 2\)"):
        draw_solution(path, solver, result, T_base_tip, np.ones((4, 2)))
    assert path.read_bytes() == b"old"
    with pytest.raises(OSError, match="missing"):
        draw_solution(tmp_path / "missing" / "a.png", solver, result, T_base_tip)


@pytest.mark.parametrize("name", NAMES)
def test_gaps_have_the_sign_and_never_more_than_the_size_of_the_judges_clearance(name: str) -> None:
    solver, result, T_base_tip = solved(name)
    hulls = placed_hulls(solver.robot, result.q)
    assert hulls
    points = np.random.default_rng(1).uniform(-1, 1, (300, 3)) * [0.8, 0.8, 1.2]
    for point, gap in zip(points, gaps(hulls, points), strict=True):
        clearance = solver.judge(T_base_tip, result.q, obstacles=point[None]).clearance
        assert np.sign(gap) == np.sign(clearance)
        assert gap <= clearance + 1e-9 or clearance < 0


@pytest.mark.parametrize("name", NAMES)
def test_gaps_to_a_robot_in_capsules_are_the_judges_clearance(name: str) -> None:
    robot = with_capsules(pdoik.Robot.builtin(name))
    solver = pdoik.Solver(robot)
    rng = np.random.default_rng(2)
    q = rng.uniform(robot.lower, robot.upper)
    hulls = placed_hulls(robot, q)
    assert sum(not hull.fills for hull in hulls) >= 2
    capsules = [hull for hull in hulls if isinstance(hull, PlacedCapsule)]
    points = np.concatenate([hull.ends.mean(axis=0) for hull in capsules] * 100).reshape(-1, 3)
    points += rng.uniform(-0.25, 0.25, points.shape)
    nearest = np.min([hull.gap(points) for hull in capsules], axis=0)
    gap = gaps(hulls, points)
    for k, point in enumerate(points):
        clearance = solver.judge(robot.fk(q), q, obstacles=point[None]).clearance
        assert np.sign(gap[k]) == np.sign(clearance)
        if gap[k] == nearest[k] and clearance > 0:  # of a capsule, not of a spheroid's inequality
            assert gap[k] == pytest.approx(clearance, abs=1e-9)
    assert (gap == nearest).mean() > 0.2


def test_a_spheroid_across_a_joint_is_wide_only_if_its_link_carries_it() -> None:
    robot = pdoik.Robot.from_urdf(BRANCHED, tip_link="tip")
    on_axis, off_axis = (0.0, 0.3, 0.0), (0.3, 0.0, 0.0)  # of joint j2, from a to b
    robot.occupancy = pdoik.Occupancy(
        spheres=[("b", off_axis, 0.1), ("arm", off_axis, 0.1)],
        spheroids=[
            ("a", (0, 0, 0.2), "b", on_axis, 0.6),  # a carries both foci
            ("a", (0, 0, 0.2), "b", off_axis, 0.9),  # j2 moves them apart
            ("b", off_axis, "a", (0, 0, 1), 0.6),  # the second is on the axis: b carries both
        ],
        capsules=[("b", off_axis, on_axis, 0.1)],
    )
    assert wide_hulls(robot) == {0, 4}
    q = np.array([0.3, 0.4, 0.5])
    fills = [hull.fills for hull in placed_hulls(robot, q)]
    assert fills == [False, True, True, True, False, True]
    # The judge agrees: in one hull of each kind, far from all that fills.
    solver = pdoik.Solver(robot, pdoik.Options(goal="position"))
    for hull, filled in zip(placed_hulls(robot, q), fills, strict=True):
        point = hull.ends.mean(axis=0)
        others = [h for h in placed_hulls(robot, q) if h.fills and h is not hull]
        if gaps(others, point[None])[0] > 0:
            clearance = solver.judge(robot.fk(q), q, obstacles=point[None]).clearance
            assert (clearance < 0) == filled


@pytest.mark.parametrize("name", NAMES)
def test_the_skeleton_runs_from_base_to_tip(name: str) -> None:
    solver, result, _ = solved(name)
    bones = skeleton(solver.robot, result.q, solver.robot.tip_links[0])
    np.testing.assert_allclose(bones[0], 0, atol=1e-12)
    np.testing.assert_allclose(bones[-1], solver.robot.fk(result.q)[:3, 3], atol=1e-12)
    lengths = np.linalg.norm(np.diff(bones, axis=0), axis=1)
    other = skeleton(solver.robot, 0.5 * result.q, solver.robot.tip_links[0])
    np.testing.assert_allclose(lengths, np.linalg.norm(np.diff(other, axis=0), axis=1), atol=1e-9)


def test_the_skeleton_leaves_out_other_branches() -> None:
    robot = pdoik.Robot.from_urdf(BRANCHED, tip_link="tip")
    bones = skeleton(robot, np.zeros(3), "tip")
    np.testing.assert_allclose(bones, [[0, 0, 0], [0, 0, 1], [0, 0, 2], [0, 0, 2.5]], atol=1e-12)


def test_spheroid_facets_lie_on_the_spheroid() -> None:
    focus_a, focus_b, semi_major = np.array([0.1, 0.2, 0.3]), np.array([0.5, 0.1, 0.7]), 0.4
    soup = FacetSoup()
    axes = spheroid_axes(focus_a, focus_b, semi_major)
    soup.ellipsoid((focus_a + focus_b) / 2, axes, "red")
    corners = soup.corners.reshape(-1, 3)
    sums = sum(np.linalg.norm(corners - focus, axis=1) for focus in (focus_a, focus_b))
    np.testing.assert_allclose(sums, 2 * semi_major, atol=1e-12)
    lit = soup.lit(np.array([5.0, 0.0, 0.0]))
    assert ((lit >= 0) & (lit <= 1)).all()
    assert np.ptp(lit[:, 0]) > 0.3  # the sides differ


@pytest.mark.parametrize("b", [(0.5, 0.1, 0.7), (0.1, 0.2, 0.3)])
def test_capsule_facets_lie_on_the_capsule(b: tuple[float, float, float]) -> None:
    capsule = PlacedCapsule(name="", a=np.array([0.1, 0.2, 0.3]), b=np.array(b), radius=0.2)
    soup = FacetSoup()
    soup.capsule(capsule.a, capsule.b, capsule.radius, "red")
    np.testing.assert_allclose(capsule.gap(soup.corners.reshape(-1, 3)), 0, atol=1e-12)
    reach = np.abs(soup.corners.reshape(-1, 3) - capsule.ends.mean(axis=0))
    assert np.linalg.norm(reach, axis=1).max() == pytest.approx(capsule.extent)


def test_a_sphere_is_a_spheroid_whose_foci_coincide() -> None:
    axes = spheroid_axes(np.ones(3), np.ones(3), 0.2)
    np.testing.assert_allclose(axes.T @ axes, 0.04 * np.eye(3), atol=1e-15)


def test_the_view_avoids_points_in_front_of_the_arm() -> None:
    bones = np.array([[0, 0, 0], [0, 0, 0.5], [0.6, 0, 0.5]], dtype=float)
    wall = np.stack(np.meshgrid(np.linspace(-1, 1, 30), [-0.5], np.linspace(-0.5, 1, 30)), -1)
    azimuth = best_azimuth(bones, wall.reshape(-1, 3), 20.0)
    assert np.sin(np.radians(azimuth)) > 0.5


LIMIT = '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/>'
BRANCHED = f"""<robot name="branched">
  <link name="base"/><link name="a"/><link name="b"/><link name="camera"/><link name="arm"/>
  <link name="tip"/>
  <joint name="j1" type="revolute">
    <parent link="base"/><child link="a"/><origin xyz="0 0 1"/>{LIMIT}</joint>
  <joint name="j2" type="revolute">
    <parent link="a"/><child link="b"/><origin xyz="0 0 1"/>{LIMIT}</joint>
  <joint name="j3" type="revolute">
    <parent link="a"/><child link="arm"/><origin xyz="1 0 0"/>{LIMIT}</joint>
  <joint name="f1" type="fixed">
    <parent link="a"/><child link="camera"/><origin xyz="0 2 0"/></joint>
  <joint name="f2" type="fixed">
    <parent link="b"/><child link="tip"/><origin xyz="0 0 0.5"/></joint>
</robot>"""
