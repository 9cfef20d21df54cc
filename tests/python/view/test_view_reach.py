"""The Reach tab of pdoik view on a real server: grids, maps, cuts, cancelling, and bad input."""

from __future__ import annotations

import itertools
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

import pdoik
from command_line import misuse, run
from pdoik.view import Session

viser = pytest.importorskip("viser", reason="pip install 'pdoik[view]'")

from pdoik.view.model import builtin_model, shipped_model  # noqa: E402  # these need viser
from pdoik.view.reach import ReachRequest, box_grid, default_box, load_map  # noqa: E402
from pdoik.view.reach_cells import Cut, ReachCells, share_colors  # noqa: E402
from pdoik.view.server import start_server  # noqa: E402
from pdoik.view.viewer import Viewer  # noqa: E402

PATIENCE = 120.0  # [s], on a busy machine
PANDA = pdoik.Robot.builtin("panda")
WALL = np.array([[0.45, y, z] for y in np.arange(-1, 1, 0.04) for z in np.arange(0, 1, 0.04)])


@pytest.fixture
def viewer() -> Iterator[Viewer]:
    """A Panda before a wall, on a page that nobody looks at; its grid is small."""
    session = Session(PANDA, pdoik.Options(max_time=5.0))
    session.set_cloud(WALL)
    server = start_server("127.0.0.1", 0)
    viewer = Viewer(server, shipped_model(PANDA), session)
    set_grid(viewer, [0.3, -0.3, 0.2], [0.6, 0.3, 0.5], step=150, orientations=12)
    wait(lambda: bool(viewer.status.text))  # the worker rests
    yield viewer
    viewer.close()
    server.stop()


def set_grid(
    viewer: Viewer, low: list[float], high: list[float], *, step: float, orientations: int
) -> None:
    tab = viewer.reach_tab
    tab.low.value, tab.high.value = tuple(low), tuple(high)
    tab.step.value, tab.orientations.value = step, orientations


def wait(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def computed(viewer: Viewer) -> pdoik.Reachability:
    viewer.reach_tab.start()
    wait(lambda: not viewer.reach_tab.computing)
    assert viewer.reach_tab.map.result is not None
    return viewer.reach_tab.map.result


def message(viewer: Viewer) -> str:
    return viewer.status._message.text


def uploaded(path: Path) -> viser.UploadedFile:
    return viser.UploadedFile(path.name, path.read_bytes())


# What is computed.


@pytest.mark.parametrize("obstacles", [True, False])
def test_the_pages_map_is_the_librarys_with_what_the_session_keeps_to(
    viewer: Viewer, obstacles: bool
) -> None:
    viewer.session.set_options(clearance=0.02)
    viewer.session.set_ball([0.3, 0.0, 0.4], 0.05)
    viewer.reach_tab.obstacles.value = obstacles
    result = computed(viewer)
    grid = pdoik.Grid.box([0.3, -0.3, 0.2], [0.6, 0.3, 0.5], 0.15, orientations=12)
    np.testing.assert_array_equal(result.grid.positions, grid.positions)
    placed = viewer.session.obstacles.placed(viewer.session.obstacles.thinned())
    options = pdoik.Options(
        position_tolerance=1e-3, rotation_tolerance=1e-3, max_restarts=16, max_time=1.0,
        clearance=0.02,
    )  # fmt: skip
    again = pdoik.reachability(PANDA, placed if obstacles else None, grid, options=options)
    np.testing.assert_array_equal(result.statuses, again.statuses)
    facts = viewer.reach_tab.map.facts.content
    assert f"{again.reached.sum()} of {len(grid)} poses reached" in facts
    assert ("clear of the obstacles" in facts) == obstacles


def test_a_goal_that_asks_for_less_reaches_more(viewer: Viewer) -> None:
    pose = computed(viewer)
    viewer.session.set_goal("panda_link8", "position")
    position = computed(viewer)
    assert position.reached.sum() > pose.reached.sum()


def test_a_target_is_followed_while_a_map_is_computed_and_cancelling_keeps_the_old_one(
    viewer: Viewer,
) -> None:
    tab, session = viewer.reach_tab, viewer.session
    old = computed(viewer)
    session.set_cloud(None)
    set_grid(viewer, [-1, -1, -0.5], [1, 1, 1.5], step=50, orientations=50)  # a minute or more
    tab.start()
    tab.start()  # impatiently
    wait(lambda: tab.bar.value > 0)
    assert tab.cancel.visible
    assert not tab.compute.visible
    T = session.targets["panda_link8"]
    T[2, 3] += 0.02
    session.set_target("panda_link8", T)
    viewer.worker.wake()
    wait(lambda: np.allclose(PANDA.fk(session.q), T, atol=5e-5))
    assert tab.computing
    assert "to go" in tab.progress.content
    tab.stop()
    assert not tab.computing
    assert tab.compute.visible
    assert tab.map.result is old
    time.sleep(1.0)  # longer than a slice, after which nothing may come
    assert tab.progress.content == "cancelled"
    assert tab.map.result is old


def test_closing_ends_the_run_and_its_thread() -> None:
    server = start_server("127.0.0.1", 0)
    viewer = Viewer(server, shipped_model(PANDA), Session(PANDA))
    set_grid(viewer, [-1, -1, -0.5], [1, 1, 1.5], step=50, orientations=60)  # a minute or more
    viewer.reach_tab.start()
    wait(lambda: viewer.reach_tab.bar.value > 0)
    viewer.close()
    server.stop()
    assert viewer.reach_tab.map.result is None
    assert not [each for each in threading.enumerate() if each.name.startswith("pdoik view")]


def test_another_robot_ends_the_run_takes_the_map_away_and_gets_a_grid(viewer: Viewer) -> None:
    computed(viewer)
    set_grid(viewer, [-1, -1, -0.5], [1, 1, 1.5], step=50, orientations=50)
    viewer.reach_tab.start()
    viewer.take_builtin("ur10")
    assert not viewer.reach_tab.computing
    assert viewer.reach_tab.map.result is None
    assert viewer.reach_tab.map.facts.content == "No map."
    low, high = default_box(viewer.session.robot)
    assert (viewer.reach_tab.low.value, viewer.reach_tab.high.value) == (tuple(low), tuple(high))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"low": (1.0, 1.0, 1.0)}, "in order"),
        ({"low": (np.nan, 0.0, 0.0)}, "finite"),
        ({"high": (np.inf, 1.0, 1.0)}, "finite"),
        ({"step": 0.0}, "step is 0.0"),
        ({"step": np.nan}, "step is nan"),
        ({"orientations": 0}, "orientations is 0"),
        ({"step": 1.0, "orientations": 100}, "5,445,120,100 poses"),
        ({"orientations": 10**9}, "poses, the page takes up to 5,000,000"),
        ({"high": (1e300, 1e300, 1e300)}, "poses, the page takes up to 5,000,000"),
    ],
)
def test_a_grid_that_makes_no_sense_is_told_and_loses_nothing(
    viewer: Viewer, change: dict[str, object], words: str
) -> None:
    old = computed(viewer)
    for name, value in change.items():
        getattr(viewer.reach_tab, name).value = value
    viewer.reach_tab.start()
    assert words in message(viewer)
    assert not viewer.reach_tab.computing
    assert viewer.reach_tab.map.result is old


def test_several_tips_a_free_tip_and_a_cloud_that_cannot_be_thinned_are_told(
    viewer: Viewer,
) -> None:
    viewer.session.set_cloud([[0.0, 0.0, 0.0], [5e4, 5e4, 5e4]])
    viewer.session.set_thinning(1e-3, False)
    viewer.reach_tab.start()
    wait(lambda: not viewer.reach_tab.computing)
    assert "cells" in message(viewer)
    assert viewer.reach_tab.progress.content == "45 positions, 540 poses"
    assert viewer.reach_tab.compute.visible
    viewer.session.set_goal("panda_link8", "free")
    viewer.reach_tab.start()
    assert "free" in message(viewer)
    viewer.drop_cloud()  # of which the worker complains too
    viewer.take_builtin("h1")
    viewer.reach_tab.start()
    assert "one tip" in message(viewer)


@pytest.mark.parametrize("name", pdoik.Robot.builtin_names())
def test_the_proposed_box_holds_what_the_tip_reaches(name: str) -> None:
    robot = pdoik.Robot.builtin(name)
    low, high = default_box(robot)
    rng = np.random.default_rng(7)
    tip = robot.tip_links[0]
    qs = rng.uniform(robot.lower, robot.upper, (500, robot.dof))
    tips = np.array([robot.fk(q, tip)[:3, 3] for q in qs])
    assert ((tips >= low - 1e-9) & (tips <= high + 1e-9)).all()
    assert (np.ptp(tips, axis=0) > 0.7 * (high - low)).all()


def test_a_robot_without_hulls_is_asked_without_obstacles() -> None:
    bare = PANDA.__copy__()
    bare.occupancy = pdoik.Occupancy()
    session = Session(bare)
    session.set_cloud(WALL)
    grid = box_grid([0.3, 0.0, 0.3], [0.4, 0.0, 0.3], 0.1, 2)
    assert ReachRequest.of(session, grid, with_obstacles=True).obstacles is None


# What is drawn.


def visible_by_brute_force(centers: np.ndarray, edge: float, cut: Cut | None) -> int:
    """How many faces of cubes on a grid are bare."""
    if cut is not None:
        centers = centers[cut.keeps(centers)]
    there = {tuple(np.round(c / edge, 3)) for c in centers}
    ways = [way for way in itertools.product((-1, 0, 1), repeat=3) if np.abs(way).sum() == 1]
    return sum(tuple(np.round(np.add(c, way), 3)) not in there for c in there for way in ways)


@pytest.mark.parametrize(
    "cut",
    [None, Cut(axis=0, at=0.35), Cut(axis=1, at=0.0), Cut(axis=2, at=0.3, keep_above=False)],
)
def test_what_is_drawn_is_every_face_that_no_cube_covers(cut: Cut | None) -> None:
    grid = pdoik.Grid.box([-0.9, -0.9, -0.3], [0.9, 0.9, 1.2], 0.15, orientations=4)
    result = pdoik.reachability(PANDA, None, grid)
    cells = ReachCells(result)
    assert cells.edge == pytest.approx(0.15)
    assert len(cells.centers) == result.reached.any(axis=1).sum()
    squares = cells.visible(cut)
    assert len(squares.shares) == visible_by_brute_force(cells.centers, 0.15, cut)
    spread = np.ptp(squares.corners, axis=1)  # (F, 3)
    np.testing.assert_allclose(
        np.sort(spread), np.tile([0, 0.15, 0.15], (len(spread), 1)), atol=1e-9
    )
    np.testing.assert_array_equal(spread.argmin(axis=1), squares.axes)
    share_at = {tuple(c.round(6)): s for c, s in zip(cells.centers, cells.shares, strict=True)}
    edge_a, edge_b = (squares.corners[:, k + 1] - squares.corners[:, k] for k in (0, 1))
    outward = np.cross(edge_a, edge_b) / 0.15**2
    centers = squares.corners.mean(axis=1) - 0.075 * outward
    assert [share_at[tuple(c)] for c in (centers + 0.0).round(6) + 0.0] == list(squares.shares)


def test_places_off_a_lattice_are_cubes_with_all_their_faces() -> None:
    rng = np.random.default_rng(0)
    grid = pdoik.Grid(rng.uniform(0.2, 0.5, (20, 3)), np.eye(3)[None])
    statuses = np.zeros((20, 1), dtype=np.uint8)
    result = pdoik.Reachability(grid, statuses, np.zeros((20, 1, 7), np.float32), 1.0)
    assert len(ReachCells(result).visible(None).shares) == 6 * 20
    one = pdoik.Grid(np.zeros((1, 3)), np.eye(3)[None])
    alone = pdoik.Reachability(one, statuses[:1], np.zeros((1, 1, 7), np.float32), 1.0)
    assert len(ReachCells(alone).visible(None).shares) == 6


def test_the_colours_grow_brighter_evenly() -> None:
    red, green, blue = (share_colors(np.linspace(0, 1, 6)) / 255.0).T
    luminance = 0.2126 * red**2.2 + 0.7152 * green**2.2 + 0.0722 * blue**2.2
    lightness = np.diff(116 * np.cbrt(luminance) - 16)
    assert lightness.min() > 10
    assert lightness.max() < 1.5 * lightness.min()


def test_the_cut_is_drawn_by_the_controls_and_hiding_takes_all_away(viewer: Viewer) -> None:
    computed(viewer)
    panel = viewer.reach_tab.map
    drawn = panel._scene._drawn
    assert drawn is not None
    assert drawn[1] == Cut(axis=1, at=0.0)
    panel.other_side.value = True
    panel.at.value = 0.15
    wait(lambda: panel._scene._drawn == (drawn[0], Cut(axis=1, at=0.15, keep_above=False)))
    panel.axis.value = "x"
    wait(lambda: panel._scene._drawn == (drawn[0], Cut(axis=0, at=0.3, keep_above=False)))
    assert (panel.at.min, panel.at.max) == pytest.approx((0.3, 0.6))
    panel.axis.value = "nothing"
    wait(lambda: panel._scene._drawn == (drawn[0], None))
    assert not panel.at.visible
    panel.shown.value = False
    wait(lambda: panel._scene._drawn is None)
    assert panel._scene._cubes is None


# Files.


def test_a_map_comes_back_from_its_file(viewer: Viewer, tmp_path: Path) -> None:
    result = computed(viewer)
    result.save(tmp_path / "wall.npz")
    viewer.reach_tab.map.forget()
    viewer.take_map(uploaded(tmp_path / "wall.npz"))
    again = viewer.reach_tab.map.result
    assert again is not None
    np.testing.assert_array_equal(again.statuses, result.statuses)
    assert "from wall.npz" in viewer.reach_tab.map.facts.content


def test_the_command_shows_a_file_until_ctrl_c(tmp_path: Path) -> None:
    path = tmp_path / "map.npz"
    grid = box_grid([0.3, 0.0, 0.3], [0.6, 0.0, 0.6], 0.1, 4)
    pdoik.reachability(PANDA, None, grid).save(path)
    command = [sys.executable, "-m", "pdoik.cli", "view", "panda", "--no-open", "--port=0"]
    with subprocess.Popen(
        [*command, "--reach", path], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline().startswith("http://127.0.0.1:")
        process.send_signal(signal.SIGINT)
        rest, complaints = process.communicate(timeout=PATIENCE)
    assert (process.returncode, rest, complaints) == (0, "", "")


@pytest.fixture(scope="module")
def bad_maps(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Files that are no map of the Panda."""
    folder = tmp_path_factory.mktemp("maps")
    paths = {name: folder / f"{name}.npz" for name in ("arm", "tip", "nan", "answers", "half")}
    grid = pdoik.Grid.box([0.3, -0.3, 0.3], [0.6, 0.3, 0.5], 0.3, orientations=4)
    pdoik.reachability(pdoik.Robot.builtin("ur10"), None, grid).save(paths["arm"])
    iiwa = pdoik.reachability(pdoik.Robot.builtin("iiwa14"), None, grid)
    iiwa.save(paths["tip"])  # has the Panda's seven joints
    whole = paths["tip"].read_bytes()
    arrays = dict(np.load(paths["tip"]))
    np.savez(paths["nan"], **{**arrays, "positions": np.nan * arrays["positions"]})
    np.savez(paths["answers"], **{**arrays, "q": np.nan * arrays["q"]})
    paths["half"].write_bytes(whole[: len(whole) // 2])
    return paths


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("arm", "of a robot with 6 joints, panda has 7"),
        ("tip", "of another robot or tip"),
        ("nan", "NaN"),
        ("answers", "an answer with NaN"),
        ("half", "not a reachability file"),
    ],
)
def test_a_file_that_is_no_map_of_the_robot_is_told_and_loses_nothing(
    viewer: Viewer, bad_maps: dict[str, Path], kind: str, words: str
) -> None:
    old = computed(viewer)
    viewer.take_map(uploaded(bad_maps[kind]))
    assert f"{kind}.npz" in message(viewer)
    assert words in message(viewer)
    assert viewer.reach_tab.map.result is old
    with pytest.raises(pdoik.LoadError, match=words):
        load_map(bad_maps[kind], PANDA)
    misuse(run("view", "panda", "--no-open", "--reach", bad_maps[kind]), "--reach", words)


def test_a_map_that_is_not_there_and_one_for_several_tips_are_refused(tmp_path: Path) -> None:
    misuse(run("view", "panda", "--no-open", "--reach", tmp_path / "no.npz"), "--reach", "no.npz")
    h1 = builtin_model("h1").robot
    grid = pdoik.Grid.box([0.3, 0.0, 0.3], [0.3, 0.0, 0.3], 0.1)
    statuses, q = np.ones((1, 1), dtype=np.uint8), np.zeros((1, 1, h1.dof), dtype=np.float32)
    pdoik.Reachability(grid, statuses, q, 1.0).save(tmp_path / "h1.npz")
    with pytest.raises(pdoik.LoadError, match="several"):
        load_map(tmp_path / "h1.npz", h1)
