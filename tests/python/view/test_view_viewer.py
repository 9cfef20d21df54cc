"""The page's viewer without a browser: two hands at once, files that are none, narrow windows."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from types import SimpleNamespace

import numpy as np
import pytest

import pdoik
from pdoik.view import Session

viser = pytest.importorskip("viser", reason="pip install 'pdoik[view]'")

from pdoik.view.camera import fitted  # noqa: E402  # these need viser
from pdoik.view.examples import EXAMPLES  # noqa: E402
from pdoik.view.log import Log  # noqa: E402
from pdoik.view.model import builtin_model  # noqa: E402
from pdoik.view.server import start_server  # noqa: E402
from pdoik.view.viewer import Viewer  # noqa: E402

PATIENCE = 120.0  # [s], on a busy machine


@pytest.fixture(scope="module")
def viewer() -> Iterator[Viewer]:
    """A Panda, on a page that nobody looks at; what is done to it stays."""
    model = builtin_model("panda")
    server = start_server("127.0.0.1", 0)
    viewer = Viewer(server, model, Session(model.robot, pdoik.Options(max_time=5.0)))
    yield viewer
    viewer.close()
    server.stop()


def wait(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def message(viewer: Viewer) -> str:
    return viewer.status._message.text


def test_a_target_that_is_typed_is_taken_and_what_was_not_typed_is_not_rounded(
    viewer: Viewer,
) -> None:
    tip, session = "panda_link8", viewer.session
    T = session.targets[tip]
    assert viewer.solve_tab.targets is not None
    xyz, turn = viewer.solve_tab.targets.by_tip[tip]
    np.testing.assert_allclose(xyz.value, T[:3, 3], atol=1e-4)
    typed = viewer.solve_tab.targets._callback(tip, viewer.type_target)
    xyz.value = (0.5, 0.1, 0.4)
    typed(SimpleNamespace(client="a hand", target=xyz))
    np.testing.assert_array_equal(session.targets[tip][:3, 3], [0.5, 0.1, 0.4])
    np.testing.assert_array_equal(session.targets[tip][:3, :3], T[:3, :3])
    wait(lambda: session._wish == session._granted)
    turn.value = (180.0, 0.0, 90.0)
    typed(SimpleNamespace(client="a hand", target=turn))
    R = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]
    np.testing.assert_allclose(viewer.targets.by_tip[tip].pose[:3, :3], R, atol=1e-9)
    wait(lambda: np.allclose(session.robot.fk(session.q), session.targets[tip], atol=5e-5))
    xyz.value = (np.nan, 0.0, 0.0)
    typed(SimpleNamespace(client="a hand", target=xyz))
    assert "finite" in message(viewer)


@pytest.mark.parametrize(
    ("take", "name", "content", "words"),
    [
        ("take_cloud", "scan.ply", b"hello", "not a .ply file"),
        ("take_cloud", "scan.pcd", b"", "scan.pcd"),
        ("take_cloud", "photo.jpg", b"\xff\xd8\xff", "photo.jpg"),
        ("take_cloud", "scan.xyz", b"1 2\n3 4\n", "scan.xyz"),
        ("take_cloud", "..", b"", ""),
        ("take_urdf", "arm.urdf", b"", "arm.urdf"),
        ("take_urdf", "arm.urdf", b"hello", "arm.urdf"),
        ("take_urdf", "arm.urdf", b"<robot name='a'><link name='base'/></robot>", "joint"),
        ("take_hulls", "hulls.yaml", b"[1, 2]", "hulls.yaml"),
        ("take_scene", "table.yaml", b"\x00\x01", "table.yaml"),
        ("take_log", "log.csv", b"time\n", "log.csv"),
        ("take_map", "map.npz", b"PK", "map.npz"),
    ],
)
def test_a_file_that_is_none_is_told_and_loses_nothing(
    viewer: Viewer, take: str, name: str, content: bytes, words: str
) -> None:
    model, session, q = viewer.model, viewer.session, viewer.session.q
    session.set_cloud([[1.5, 0.0, 0.2]])
    getattr(viewer, take)(viser.UploadedFile(name, content))
    text = viewer.status._message._html.content
    assert "#b3261e" in text, text
    assert words in message(viewer)
    assert viewer.model is model
    assert viewer.session is session
    assert len(session.obstacles.surface) == 1
    np.testing.assert_array_equal(session.q, q)


def test_two_hands_choose_robots_at_once_while_a_log_is_replayed(viewer: Viewer) -> None:
    n = viewer.session.robot.dof
    time_ = np.linspace(0.0, 60.0, 601)
    q = np.sin(time_)[:, None] * np.full(n, 0.2) + viewer.session.q
    log = Log(name="log.csv", time=time_, signals={"q": q}, object_pose=None)
    viewer.replay_tab.load(log)
    viewer.replay_tab.player.play()
    wait(lambda: viewer.replay_tab.player.elapsed > 0.1)
    complaints: list[BaseException] = []
    heard, threading.excepthook = threading.excepthook, lambda args: complaints.append(args)

    def choose(choices: list[Callable[[], None]]) -> None:
        for each in choices:
            each()

    hands = [
        threading.Thread(target=choose, args=[choices])
        for choices in (
            [lambda: viewer.take_builtin("ur10"), lambda: viewer.take_example(EXAMPLES[0])] * 2,
            [lambda: viewer.take_builtin("iiwa14"), lambda: viewer.take_example(EXAMPLES[1])] * 2,
        )
    ]
    for hand in hands:
        hand.start()
    for hand in hands:
        hand.join()
    session, robot = viewer.session, viewer.model.robot
    wait(lambda: session._wish == session._granted)
    threading.excepthook = heard
    assert complaints == []
    assert session.robot is robot
    assert viewer.robot_scene._robot is robot
    assert list(viewer.targets.by_tip) == robot.tip_links
    assert viewer.joints_tab is not None
    assert len(viewer.joints_tab.sliders) == robot.dof
    assert message(viewer).startswith(f"{robot.name}: {robot.dof} joints")
    viewer.replay_tab.player.play()  # its thread is there, and has nothing to play
    wait(lambda: viewer.replay_tab.player.elapsed > 0.0)


def test_a_urdf_whose_meshes_are_not_there_is_taken_and_says_so(viewer: Viewer) -> None:
    urdf = """<robot name="arm"><link name="base"/><link name="tool"><visual><geometry>
      <mesh filename="package://nowhere/tool.stl"/></geometry></visual></link>
      <joint name="turn" type="continuous"><parent link="base"/><child link="tool"/>
      <origin xyz="0 0 0.4"/><axis xyz="1 0 0"/></joint></robot>"""
    viewer.take_urdf(viser.UploadedFile("arm.urdf", urdf.encode()))
    assert viewer.session.robot.name == "arm"
    assert "1 links lack meshes" in message(viewer)


def test_a_narrow_window_sees_the_same_from_farther_off() -> None:
    look_at, position = np.array([0.4, 0.1, 0.4]), np.array([1.4, -1.5, 1.0])
    wide = fitted(look_at, position, 0.7, 1.6)
    np.testing.assert_array_equal(wide, (look_at, position))
    target, camera = fitted(look_at, position, 0.7, 0.46)
    way, before = camera - target, position - look_at
    np.testing.assert_allclose(way / np.linalg.norm(way), before / np.linalg.norm(before))
    np.testing.assert_array_equal(target, look_at)
    assert 1.5 < np.linalg.norm(way) / np.linalg.norm(before) < 3.0
