"""pdoik view plays a whole path: its line, its colours, and the place where it breaks."""

from __future__ import annotations

import io
import shutil
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import pdoik
from command_line import misuse, run
from pdoik.view import Session
from pdoik.view.drawing.shapes import room_colors
from pdoik.view.followed_path import station_places

DOWN = np.diag([1.0, -1.0, -1.0, 1.0])
SEAM = "x,y,z,qx,qy,qz,qw\n0.5,-0.3,0.25,1,0,0,0\n0.5,0.3,0.25,1,0,0,0\n"
PATIENCE = 120.0  # [s], with software rendering on a busy machine
FLAGS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--no-first-run",
    "--disable-background-networking",
]


def at(x: float, y: float, z: float) -> np.ndarray:
    T = DOWN.copy()
    T[:3, 3] = x, y, z
    return T


def line() -> np.ndarray:
    return pdoik.sample_path([at(0.5, -0.3, 0.25), at(0.5, 0.3, 0.25)], 0.02)


def upright(x: float, y: float, z: float) -> np.ndarray:
    T = np.eye(4)
    T[:3, 3] = x, y, z
    return T


def beside() -> pdoik.Shape:
    return pdoik.Shape.sphere("ball", (0.3, 0.2, 0.5), 0.1)


def across() -> pdoik.Shape:
    return pdoik.Shape.cylinder("post", 0.04, 0.6, upright(0.5, 0.05, 0.3))


@pytest.fixture
def session() -> Session:
    return Session(pdoik.Robot.builtin("panda"), pdoik.Options(max_time=5.0))


def test_each_row_has_the_room_that_a_judge_finds_and_the_line_is_the_tools(
    session: Session,
) -> None:
    session.set_shapes([beside()])
    followed = session.follow("seam.csv", line())
    assert followed.result.success, followed.result.message
    assert followed.log is not None
    q = followed.log.signals["q"]
    solver = pdoik.Solver(session.robot, session.options)
    for row, room, place in zip(q, followed.room, followed.lines[0], strict=True):
        T = session.robot.fk(row)
        verdict = solver.judge(T, row, [beside()])
        assert room == pytest.approx(verdict.clearance, abs=1e-12)
        np.testing.assert_allclose(place, T[:3, 3])
        assert abs(place[0] - 0.5) < 1e-3
    assert followed.room.min() == pytest.approx(followed.result.clearance, abs=1e-6)
    session.set_shapes([])
    alone = session.follow("seam.csv", line())
    assert alone.room.min() == pytest.approx(alone.result.self_distance, abs=1e-6)
    assert not followed.is_move.any()
    assert followed.breaks == ()
    assert (np.diff(followed.log.time) > 0).all()
    assert followed.log.row_notes[0].startswith("station 0.0, ")
    speed = np.abs(np.diff(q, axis=0)) / np.diff(followed.log.time)[:, None]
    assert (speed <= 0.101 * session.robot.velocity).all()


def test_where_it_breaks_is_marked_with_the_reason_and_moves_are_told_from_the_path(
    session: Session,
) -> None:
    session.set_shapes([across()])
    followed = session.follow("seam.csv", line())
    assert not followed.result.success
    assert followed.breaks
    for each, end in zip(followed.breaks, followed.result.ends, strict=True):
        np.testing.assert_allclose(each.place, session.robot.fk(end.q)[:3, 3])
        assert each.text.endswith(end.reason)
        assert f"station {end.at:.1f}" in each.text
    assert len(followed.unsolved) == len(followed.result.unsolved)
    assert followed.log is not None
    assert "Breaks at station" in followed.log.expected
    first, end = followed.result.pieces[0]
    assert not followed.is_move[: end - first].any()
    moved = sum(len(move) for move in followed.result.moves)
    assert followed.is_move.any() == (len(followed.result.pieces) > 1)
    assert len(followed.room) >= sum(b - a for a, b in followed.result.pieces) or not moved


def test_places_of_stations_are_those_in_the_base_frame() -> None:
    T = at(0.1, 0.2, 0.3)
    places = station_places([pdoik.Goal(T, type="axis"), [pdoik.Goal(T)], T])
    np.testing.assert_array_equal(places, [[0.1, 0.2, 0.3]] * 3)
    np.testing.assert_array_equal(station_places(np.array([T, T])), [[0.1, 0.2, 0.3]] * 2)
    relative = pdoik.Goal(T, tip="right", relative_to="left")
    assert station_places([[relative]]).shape == (0, 3)


def test_colours_go_from_red_where_it_touches_to_blue_where_there_is_room() -> None:
    red, _, blue = room_colors(np.array([0.0, 0.5, np.inf])).astype(int)
    assert red[0] > 200 > red[2] + 100
    assert blue[2] > blue[0]
    np.testing.assert_array_equal(*room_colors(np.array([0.25, np.inf])))


def test_a_path_that_cannot_be_read_ends_the_command_before_a_page_is_opened(
    tmp_path: Path,
) -> None:
    pytest.importorskip("viser", reason="pip install 'pdoik[view]'")
    file = tmp_path / "seam.csv"
    misuse(run("view", "panda", "--no-open", "--path", file), "--path", "seam.csv")
    file.write_text("x,y\n1,2\n")
    misuse(run("view", "panda", "--no-open", "--path", file), "--path", "there is no z")
    file.write_text(SEAM)
    misuse(run("view", "panda", "--no-open", "--path", file, "--spacing", "-1"), "spacing")


# In a browser.


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    pytest.importorskip("viser", reason="pip install 'pdoik[view]'")
    playwright = pytest.importorskip("playwright.sync_api", reason="pip install 'pdoik[test]'")
    chromium = shutil.which("chromium")
    if chromium is None:
        pytest.skip("apt-get install chromium")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=chromium, args=FLAGS)
        yield browser
        browser.close()


def test_a_path_that_is_loaded_is_drawn_played_and_followed_again_around_what_came(
    browser: Any, session: Session, tmp_path: Path
) -> None:
    from pdoik.cli.path_file import read_path_file
    from pdoik.view.model import shipped_model
    from pdoik.view.server import start_server
    from pdoik.view.viewer import Viewer

    file = tmp_path / "seam.csv"
    file.write_text(SEAM)
    server = start_server("127.0.0.1", 0)
    viewer = Viewer(
        server,
        shipped_model(session.robot),
        session,
        read_path=lambda path: read_path_file(path).stations(None, 0.02),
    )
    page = browser.new_page(viewport={"width": 1000, "height": 540})
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda said: complaints.append(said.text) if said.type == "error" else None)

    def wait(condition: Any, what: str) -> None:
        deadline = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < deadline, f"waited in vain for {what}"
            page.wait_for_timeout(50)

    def reddest() -> int:
        """By how much the reddest of the page's pixels is redder than all else."""
        shot = np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB"), dtype=int)
        scene = shot[:, :640]  # beside the panel
        return int((scene[..., 0] - scene[..., 1:].max(axis=-1)).max())

    try:
        page.goto(server.url)
        wait(lambda: bool(server.get_clients()), "a client")
        page.get_by_text("worst constraint").wait_for(timeout=1e3 * PATIENCE)
        page.get_by_role("tab", name="Replay").click()
        with page.expect_file_chooser(timeout=1e3 * PATIENCE) as chooser:
            page.get_by_role("button", name="Path (").click()
        chooser.value.set_files(file)
        page.get_by_text("one motion meets all 31 stations").first.wait_for(timeout=1e3 * PATIENCE)
        wait(lambda: abs(session.robot.fk(session.q)[1, 3] + 0.3) < 1e-3, "the first station")
        page.get_by_role("button", name="Play", exact=True).click()
        wait(lambda: abs(session.robot.fk(session.q)[1, 3] - 0.3) < 1e-3, "the last station")
        page.get_by_text("station 30.0").wait_for(timeout=1e3 * PATIENCE)
        page.screenshot(path=tmp_path / "whole.png")

        session.set_shapes([across()])
        page.get_by_role("button", name="Follow the path again").click()
        page.get_by_text("breaks at station", exact=False).first.wait_for(timeout=1e3 * PATIENCE)
        page.get_by_text("to post", exact=False).first.wait_for(timeout=1e3 * PATIENCE)
        wait(lambda: reddest() > 100, "the red mark")
        page.screenshot(path=tmp_path / "breaks.png")

        file.write_text("x,y\n1,2\n")
        with page.expect_file_chooser(timeout=1e3 * PATIENCE) as chooser:
            page.get_by_role("button", name="Path (").click()
        chooser.value.set_files(file)
        page.get_by_text("there is no z", exact=False).wait_for(timeout=1e3 * PATIENCE)
        viewer.take_builtin("ur10")
        page.get_by_text("No log.").wait_for(timeout=1e3 * PATIENCE)
        assert not page.get_by_role("button", name="Follow the path again").is_visible()
        assert complaints == []
    finally:
        page.close()
        viewer.close()
        server.stop()
