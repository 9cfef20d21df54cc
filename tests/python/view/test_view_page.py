"""pdoik view in a real browser: what the mouse does reaches the solver, and nothing leaves."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pdoik
from browser_page import HEIGHT, PATIENCE, WIDTH, Page, browser, page_of
from pdoik.view import Session
from pdoik.view.drawing.scene import robot_size
from pdoik.view.examples import EXAMPLES
from pdoik.view.reach_cells import ReachCells

__all__ = ["browser"]  # a fixture

TIP = "panda_link8"
LEFT, RIGHT, ELBOW = "left_ankle_link", "right_ankle_link", "left_elbow_link"


@pytest.fixture
def opened(browser: Any) -> Iterator[Page]:
    """A Panda behind a table with a box."""
    rng = np.random.default_rng(0)
    table = rng.uniform([0.35, -0.4, 0.02], [0.85, 0.4, 0.02], (3000, 3))
    box = rng.uniform([0.6, -0.3, 0.02], [0.75, -0.1, 0.2], (1500, 3))
    session = Session(pdoik.Robot.builtin("panda"), pdoik.Options(max_time=5.0))
    session.set_thinning(0.04, True)
    session.set_cloud(np.concatenate([table, box]))
    with page_of(browser, session) as page:
        yield page


@pytest.fixture
def in_capsules(browser: Any) -> Iterator[Page]:
    """A Panda with a bar in its hand: one capsule, in a wide ball, and no other hull."""
    robot = pdoik.Robot.builtin("panda")
    robot.occupancy = pdoik.Occupancy(
        spheres=[(TIP, (0.0, 0.2, 0.1), 0.3)],
        capsules=[(TIP, (0.0, 0.1, 0.1), (0.0, 0.3, 0.1), 0.05)],
    )
    with page_of(browser, Session(robot, pdoik.Options(max_time=5.0))) as page:
        yield page


@pytest.fixture
def standing(browser: Any) -> Iterator[Page]:
    """The H1 on its left foot; its right foot and left elbow can be dragged."""
    robot = pdoik.Robot.builtin("h1", LEFT, [RIGHT, ELBOW])
    with page_of(browser, Session(robot, pdoik.Options(max_time=5.0))) as page:
        yield page


def test_the_robot_follows_the_target_that_the_mouse_drags(opened: Page, tmp_path: Path) -> None:
    opened.settled()
    q, T = opened.q, opened.viewer.session.targets[TIP]
    opened.drag(opened.viewer.targets.by_tip[TIP], axis=2, pixels=70)
    opened.settled()
    picture = tmp_path / "dragged.png"
    opened.page.screenshot(path=picture)

    dragged = opened.viewer.session.targets[TIP]
    shift = T[:3, :3].T @ (dragged[:3, 3] - T[:3, 3])  # along the gizmo's axes
    assert shift[2] > 0.03
    np.testing.assert_allclose(shift[:2], 0, atol=1e-4)  # an arrow moves along itself only
    np.testing.assert_allclose(dragged[:3, :3], T[:3, :3], atol=1e-5)
    assert np.abs(opened.q - q).max() > 0.02
    robot = opened.viewer.session.robot
    np.testing.assert_allclose(robot.fk(opened.q), dragged, atol=5e-5)
    assert opened.page.get_by_text("solved", exact=True).is_visible()
    assert picture.stat().st_size > 20_000


def test_the_arm_gives_way_to_the_ball_that_the_mouse_drags(opened: Page) -> None:
    opened.settled()
    session, ball = opened.viewer.session, opened.viewer.obstacle_scene.ball
    q, T = opened.q, np.eye(4)
    forearm = [session.robot.fk(q, f"panda_link{i}")[:3, 3] for i in (4, 5)]
    T[:3, 3] = np.mean(forearm, axis=0) - [0, 0, 0.25]
    ball.place(T)
    opened.page.get_by_label("Ball", exact=True).check(force=True)
    opened.wait(lambda: session.obstacles.ball is not None, "the ball")
    opened.settled()
    np.testing.assert_allclose(opened.q, q, atol=1e-3)  # not in the way yet

    opened.drag(ball, axis=2, pixels=90)
    opened.settled()
    shift = ball.pose[:3, 3] - T[:3, 3]
    np.testing.assert_allclose(shift[:2], 0, atol=1e-4)
    assert shift[2] > 0.1
    assert np.abs(opened.q - q).max() > 0.02
    np.testing.assert_allclose(session.robot.fk(opened.q), session.targets[TIP], atol=5e-5)
    assert opened.page.get_by_text("solved", exact=True).is_visible()


def test_the_capsules_are_drawn_and_the_wide_hull_around_them_on_a_switch(
    in_capsules: Page,
) -> None:
    in_capsules.settled()
    page, session = in_capsules.page, in_capsules.viewer.session
    T = session.robot.fk(in_capsules.q)

    def most_blue(local: tuple[float, float, float]) -> int:
        """By how much blue is above red around a point of the tip's frame; negative: red above."""
        around = in_capsules.around(in_capsules.pixel(T[:3, :3] @ local + T[:3, 3]))
        above = (around[..., 2] - around[..., 0]).ravel()
        return int(above[np.abs(above).argmax()])

    tube, cap, wire = (0.0, 0.22, 0.1), (0.0, 0.33, 0.1), (0.0, 0.35, -0.05)
    for part in (tube, cap):
        in_capsules.wait(lambda part=part: most_blue(part) > 15, "blue")
    assert abs(most_blue(wire)) < 10  # the floor and its lines
    page.get_by_label("Bounding spheroids").check(force=True)
    in_capsules.wait(lambda: most_blue(wire) > 15, "the wide hull")
    page.get_by_label("Bounding spheroids").uncheck(force=True)
    page.get_by_label("Collision model", exact=True).uncheck(force=True)
    for part in (tube, cap, wire):
        in_capsules.wait(lambda part=part: abs(most_blue(part)) < 10, "nothing")

    page.get_by_label("Collision model", exact=True).check(force=True)
    session.set_ball(T[:3, :3] @ (0.0, 0.1, 0.1) + T[:3, 3], 0.01)
    session.set_posture(in_capsules.q)  # it stays, and is judged anew
    in_capsules.viewer.worker.wake()
    page.get_by_text("clearance of panda_link8 to obstacle").first.wait_for(timeout=1e3 * PATIENCE)
    for part in (tube, cap):
        in_capsules.wait(lambda part=part: most_blue(part) < -15, "red")


def test_a_slider_poses_the_robot_and_the_target_jumps_to_the_tip(opened: Page) -> None:
    opened.settled()
    q = opened.q
    opened.page.get_by_role("tab", name="Joints").click()
    thumb = opened.page.get_by_role("slider").first
    thumb.focus()
    for _ in range(5):
        thumb.press("ArrowRight")
    opened.wait(lambda: not np.array_equal(opened.q, q), "the posture")
    opened.settled()
    assert opened.q[0] > q[0]
    np.testing.assert_array_equal(opened.q[1:], q[1:])
    tip = opened.viewer.session.robot.fk(opened.q)
    opened.wait(
        lambda: np.allclose(opened.viewer.targets.by_tip[TIP].pose, tip, atol=1e-9), "the gizmo"
    )


def test_files_are_taken_by_the_page(opened: Page, tmp_path: Path) -> None:
    session = opened.viewer.session
    cloud = tmp_path / "points.xyz"
    cloud.write_text("1.5 0 0.1\n1.5 0 0.2\n1.5 0 0.3\n")
    opened.page.get_by_role("tab", name="Files").click()
    opened.upload("Point cloud (", cloud)
    opened.wait(lambda: len(session.obstacles.surface) == 3, "the cloud")
    opened.page.get_by_text("points.xyz: 3 points").wait_for(timeout=1e3 * PATIENCE)

    broken = tmp_path / "broken.ply"
    broken.write_text("nothing")
    opened.upload("Point cloud (", broken)
    opened.page.get_by_text("broken.ply: not a .ply file").wait_for(timeout=1e3 * PATIENCE)
    assert len(session.obstacles.surface) == 3

    scene = tmp_path / "scene.scene"
    scene.write_text("s\n* wall\n1\nbox\n0.02 1 1\n0.8 0 0.4\n0 0 0 1\n0 0 0 0\n.\n")
    opened.upload("Scene (", scene)
    opened.page.get_by_text("scene.scene: 1 shapes, 0 points").wait_for(timeout=1e3 * PATIENCE)
    opened.wait(lambda: list(opened.viewer.shape_scene._nodes) == ["wall"], "the shape")
    opened.page.get_by_role("button", name="Remove shapes").click()
    opened.wait(lambda: not opened.viewer.shape_scene._nodes, "no shape")

    names = session.robot.joint_names
    log = tmp_path / "log.csv"
    rows = [",".join(["time", *(f"q.{name}" for name in names)])]
    rows += [",".join(f"{x:.3f}" for x in [t, *(0.3 + t * np.arange(7))]) for t in (0.0, 0.1, 0.2)]
    log.write_text("\n".join(rows))
    opened.page.get_by_role("tab", name="Replay").click()
    opened.upload("Log (", log)
    opened.wait(lambda: np.allclose(opened.q, 0.3), "the log's first row")
    opened.page.get_by_role("button", name="Play", exact=True).click()
    opened.wait(lambda: np.allclose(opened.q, 0.3 + 0.2 * np.arange(7)), "the log's last row")

    arm = tmp_path / "arm.urdf"
    arm.write_text(ARM)
    opened.page.get_by_role("tab", name="Files").click()
    opened.upload("Robot (", arm)
    opened.wait(lambda: opened.viewer.session.robot.name == "arm", "the robot")
    opened.page.get_by_text("arm: 2 joints, no collision model").wait_for(timeout=1e3 * PATIENCE)
    opened.settled()


def test_a_map_is_computed_drawn_in_its_colours_cancelled_saved_and_taken_back(
    opened: Page, tmp_path: Path
) -> None:
    opened.settled()
    page, tab = opened.page, opened.viewer.reach_tab
    page.get_by_role("tab", name="Reach").click()
    page.get_by_text("7,938 positions, 238,140 poses").wait_for(timeout=1e3 * PATIENCE)
    page.get_by_label("Orientations").fill("8")
    page.get_by_text("7,938 positions, 63,504 poses").wait_for(timeout=1e3 * PATIENCE)
    page.get_by_role("button", name="Compute").click()
    opened.wait(lambda: tab.map.result is not None, "the map")
    page.get_by_text("of 63,504 poses reached").wait_for(timeout=1e3 * PATIENCE)
    result = tab.map.result
    assert result is not None

    squares = ReachCells(result).visible(tab.map.cut)
    middles = squares.corners.mean(axis=1)
    on_cut = np.isclose(middles[:, 1], middles[:, 1].min())

    def blue_minus_red(chosen: np.ndarray[Any, Any]) -> float:
        """Of the pixels in the middle of such faces on the cut, the median."""
        shot = opened.shot()
        at = [opened.pixel(middle) for middle in middles[chosen & on_cut]]
        inside = [xy for xy in at if 0 <= xy[0] < WIDTH / 2 and 0 <= xy[1] < HEIGHT]
        assert len(inside) > 10
        pixels = np.array([shot[int(y), int(x)] for x, y in inside])
        return float(np.median(pixels[:, 2] - pixels[:, 0]))

    opened.wait(lambda: blue_minus_red(squares.shares >= 0.9) < -80, "yellow")
    opened.wait(lambda: blue_minus_red(squares.shares <= 0.5) > 40, "blue and green")

    page.get_by_label("Orientations").fill("400")
    page.get_by_role("button", name="Compute").click()
    page.get_by_text("s to go").wait_for(timeout=1e3 * PATIENCE)
    page.get_by_role("button", name="Cancel").click()
    page.get_by_text("cancelled", exact=True).wait_for(timeout=1e3 * PATIENCE)
    assert tab.map.result is result

    with page.expect_download(timeout=1e3 * PATIENCE) as download:
        page.get_by_role("button", name="Save").click()
    saved = tmp_path / download.value.suggested_filename
    assert saved.name == "panda_reach.npz"
    download.value.save_as(saved)
    np.testing.assert_array_equal(pdoik.Reachability.load(saved).statuses, result.statuses)
    opened.upload("Map (", saved)
    opened.wait(lambda: tab.map.result is not result, "the file's map")
    page.get_by_text("from panda_reach.npz").wait_for(timeout=1e3 * PATIENCE)


def test_alternatives_are_added_one_is_met_and_all_solutions_are_clicked_through(
    opened: Page,
) -> None:
    opened.settled()
    page, viewer, session = opened.page, opened.viewer, opened.viewer.session
    opened.wait(lambda: viewer.nearest_scene._color is not None, "the line to the table")
    page.get_by_text("Alternative targets").click()
    page.get_by_role("button", name="add", exact=True).click()
    opened.wait(lambda: len(session.tip_goals[TIP].targets) == 2, "another target")
    page.get_by_text("goal 1 of 2 is met").wait_for(timeout=1e3 * PATIENCE)
    T = session.targets[TIP]
    T[0, 3] += 3.0
    viewer.type_target(TIP, T)
    page.get_by_text("goal 2 of 2 is met").wait_for(timeout=1e3 * PATIENCE)
    second = viewer.targets.all_of(TIP)[1]
    opened.drag(second, axis=2, pixels=30)
    opened.settled()
    np.testing.assert_allclose(session.robot.fk(opened.q), second.pose, atol=5e-5)

    solutions = viewer.solve_tab.solutions
    assert solutions is not None
    page.get_by_text("All solutions").first.click()
    page.get_by_label("At most").fill("5")
    opened.wait(lambda: solutions.limit.value == 5, "the limit")
    page.get_by_role("button", name="All solutions").click()
    page.get_by_text("5 solutions of goal 2 of 2").wait_for(timeout=1e3 * PATIENCE)
    opened.settled()
    q = opened.q
    page.get_by_role("button", name="next", exact=True).click()
    page.get_by_text("No. 2: ").wait_for(timeout=1e3 * PATIENCE)
    page.get_by_text("chosen solution").wait_for(timeout=1e3 * PATIENCE)
    opened.settled()
    assert np.abs(opened.q - q).max() > 0.09
    np.testing.assert_allclose(session.robot.fk(opened.q), second.pose, atol=5e-5)
    page.get_by_role("tab", name="Joints").click()
    page.get_by_text("nearest joint limit: panda_joint").wait_for(timeout=1e3 * PATIENCE)
    assert page.get_by_text("● panda_joint", exact=False).count() >= 1
    viewer.type_target(TIP, session.tip_goals[TIP].targets[1], 1)
    opened.wait(lambda: solutions.text == "something has moved since", "them to be forgotten")

    page.get_by_role("tab", name="Solve").click()
    page.get_by_role("button", name="remove last").click()
    opened.wait(lambda: len(session.tip_goals[TIP].targets) == 1, "one target")
    page.get_by_label("Goal", exact=True).click()
    page.get_by_role("option", name="look at", exact=True).click()
    opened.wait(lambda: session.goals[TIP] == "look_at", "the goal")
    page.get_by_text("Axis tolerance [deg]").wait_for(timeout=1e3 * PATIENCE)
    page.get_by_text("solved", exact=True).wait_for(timeout=1e3 * PATIENCE)


def test_one_tip_of_the_h1_is_dragged_while_its_foot_stays_until_it_is_let_go(
    standing: Page,
) -> None:
    standing.settled()
    session, gizmos = standing.viewer.session, standing.viewer.targets.by_tip
    q, foot, T = standing.q, session.targets[RIGHT], session.targets[ELBOW]
    standing.drag(gizmos[ELBOW], axis=2, pixels=60)
    standing.settled()
    dragged = session.targets[ELBOW]
    assert np.linalg.norm(dragged[:3, 3] - T[:3, 3]) > 0.03
    assert np.abs(standing.q - q).max() > 0.02
    np.testing.assert_allclose(
        session.robot.fk(standing.q, ELBOW)[:3, 3], dragged[:3, 3], atol=5e-5
    )
    reached = session.robot.fk(standing.q, RIGHT)
    assert np.linalg.norm(reached[:3, 3] - foot[:3, 3]) < 1e-4
    assert standing.page.get_by_text("solved", exact=True).is_visible()

    page = standing.page
    page.get_by_label("Self-collision", exact=True).uncheck(force=True)  # on for a shipped robot
    standing.wait(lambda: session.options.self_collision is False, "no self-collision")
    page.get_by_label("Self-collision", exact=True).check(force=True)
    standing.wait(lambda: session.options.self_collision, "the self-collision")
    page.get_by_label("Balance", exact=True).check(force=True)
    standing.wait(lambda: len(session.options.balance.contacts) == 2, "the balance")
    for words in ("self-collision", "balance"):
        page.get_by_text(words, exact=True).wait_for(timeout=1e3 * PATIENCE)
    page.get_by_label("right ankle", exact=True).click()
    page.get_by_role("option", name="free", exact=True).click()
    standing.wait(lambda: session.goals[RIGHT] == "free", "the foot to be free")
    standing.settled()


def test_the_front_door_moves_shapes_changes_robots_and_outlives_a_page_closed_in_mid_drag(
    browser: Any,
) -> None:
    _, session = EXAMPLES[0].make()
    with page_of(browser, session, EXAMPLES[0]) as first:
        first.settled()
        viewer, page = first.viewer, first.page
        (box,) = (shape for shape in session.obstacles.shapes if shape.name == "box")
        T_before = np.asarray(box.T_base_shape)
        first.drag(viewer._gripped[1], axis=2, pixels=40)
        first.settled()
        (box,) = (shape for shape in session.obstacles.shapes if shape.name == "box")
        T_after = np.asarray(box.T_base_shape)
        np.testing.assert_allclose((T_after - T_before)[:2, 3], 0, atol=1e-4)
        assert T_after[2, 3] - T_before[2, 3] > 0.03
        np.testing.assert_allclose(viewer.shape_scene._nodes["box"].position, T_after[:3, 3])

        second = browser.new_page(viewport={"width": 600, "height": 400})
        second.goto(viewer.server.url)
        page.get_by_text("2 pages are open").wait_for(timeout=1e3 * PATIENCE)
        gizmo = viewer.targets.by_tip[TIP]
        T = gizmo.pose
        grip = first.pixel(T[:3, 3] + 0.85 * gizmo.scale * T[:3, 1])

        def is_lit() -> bool:
            page.mouse.move(*(grip + 1))
            page.mouse.move(*grip)
            return first.is_yellow(grip)

        first.wait(is_lit, "the arrow to see the mouse")
        page.mouse.down()
        page.mouse.move(grip[0] - 25, grip[1] + 12)
        first.wait(lambda: not np.array_equal(gizmo.pose, T), "the drag")
        page.close()

        first.page = second  # which saw it all, and goes on
        second.get_by_text("solved", exact=True).wait_for(timeout=1e3 * PATIENCE)
        first.wait(lambda: len(viewer.server.get_clients()) == 1, "the page to be gone")
        second.get_by_label("Example", exact=True).click()
        second.get_by_role("option", name="H1 on its feet").click()
        first.wait(lambda: viewer.session.robot.name == "h1", "the H1")
        first.wait(lambda: viewer._gripped is None, "no arrows of a shape that is gone")
        first.settled()
        second.close()


def test_a_half_space_is_a_surface_and_the_nearest_joint_limit_a_ring(browser: Any) -> None:
    robot = pdoik.Robot.builtin("panda")
    q = robot.mid_configuration()
    q[5] = robot.upper[5] - np.radians(3.0)
    session = Session(robot, pdoik.Options(max_time=5.0), q0=q)
    session.set_shapes([pdoik.Shape.half_space("floor", (0, 0, 1), (0, 0, -0.05))])
    session.set_posture(q)
    with page_of(browser, session) as page:
        page.settled()
        places = [(0.63, y, -0.05) for y in (-0.12, 0.33)]  # on the floor, beside the robot

        def darkness() -> list[float]:
            shot = page.shot()
            at = [page.pixel(np.array(place)).astype(int) for place in places]
            return [255.0 - float(np.median(shot[y - 4 : y + 5, x - 4 : x + 5])) for x, y in at]

        page.wait(lambda: min(darkness()) > 12, "the floor")
        page.page.get_by_label("Shapes", exact=True).uncheck(force=True)
        page.wait(lambda: max(darkness()) < 8, "no floor")

        scene = page.viewer.limit_scene
        assert scene._label.text == "panda_joint6: 3.0° to its upper limit"
        page.page.get_by_text("panda_joint6, 3.0° to its upper limit (1 % of its range)").wait_for(
            timeout=1e3 * PATIENCE
        )
        T = robot.fk(q, "panda_link6")
        np.testing.assert_allclose(scene._ring.position, T[:3, 3], atol=1e-9)
        size = 0.085 * robot_size(page.viewer.model)
        around = [size * np.array([np.cos(a), np.sin(a), 0.0]) for a in np.arange(12) * np.pi / 6]

        def orange() -> int:
            """Of places on the ring, those that are: the rest are behind the arm."""
            shot = page.shot()
            at = [page.pixel(T[:3, :3] @ each + T[:3, 3]).astype(int) for each in around]
            colors = [shot[y - 3 : y + 4, x - 3 : x + 4].reshape(-1, 3) for x, y in at]
            return sum(bool((each[:, 0] - each[:, 2]).max() > 90) for each in colors)

        page.wait(lambda: orange() >= 4, "the ring")
        page.page.get_by_label("Nearest joint limit").uncheck(force=True)
        page.wait(lambda: orange() == 0, "no ring")
        page.page.get_by_label("Nearest joint limit").check(force=True)
        page.wait(lambda: orange() >= 4, "the ring again")


ARM = """<robot name="arm">
  <link name="base"/>
  <link name="arm">
    <visual>
      <origin xyz="0 0 0.2"/><geometry><cylinder radius="0.05" length="0.4"/></geometry>
    </visual>
  </link>
  <link name="tool"/>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="arm"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="10" velocity="1"/></joint>
  <joint name="wrist" type="continuous"><parent link="arm"/><child link="tool"/>
    <origin xyz="0 0 0.4"/><axis xyz="1 0 0"/></joint>
</robot>"""
