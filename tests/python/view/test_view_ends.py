"""pdoik view ends with status 0 and in silence once its page answers, whatever it is doing then."""

import itertools
import math
import os
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from queue import SimpleQueue
from typing import Any

import numpy as np
import pytest

viser = pytest.importorskip("viser", reason="pip install 'pdoik[view]'")
msgspec = pytest.importorskip("msgspec")
websockets = pytest.importorskip("websockets.sync.client")
from websockets.exceptions import ConnectionClosed  # noqa: E402  # comes with viser

PATIENCE = 120.0  # [s], on a busy machine
LEFT, RIGHT, LEFT_ARM = "left_ankle_link", "right_ankle_link", "left_elbow_link"
H1 = ["h1", "--base-link", LEFT, "--tip-link", RIGHT, "--tip-link", LEFT_ARM]


@contextmanager
def serving(
    tmp_path: Path, *arguments: str | Path
) -> Iterator[tuple["subprocess.Popen[str]", int]]:
    """The command and its port, from the moment its page first answers."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "pdoik.cli", "view", *map(str, arguments), "--no-open"]
    with subprocess.Popen(
        [*command, f"--port={port}"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "TMPDIR": str(tmp_path)},
    ) as process:  # fmt: skip
        try:
            patient_until = time.monotonic() + PATIENCE
            while not answers(port):
                assert process.poll() is None, process.communicate()
                assert time.monotonic() < patient_until
            yield process, port
        finally:
            process.kill()


def answers(port: int) -> bool:
    try:
        with urllib.request.urlopen(f"http://127.0.0.1:{port}") as page:
            return bool(page.status == 200)
    except OSError:
        return False


def ends_cleanly(process: "subprocess.Popen[str]", url: str) -> None:
    said, complaints = process.communicate(timeout=PATIENCE)
    assert (process.returncode, complaints) == (0, "")
    assert said == f"{url}  (Ctrl-C ends it)\n"


@pytest.mark.parametrize("turn", range(3))
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("robot", [["panda"], H1], ids=["panda", "h1"])
def test_it_ends_cleanly_as_soon_as_its_page_answers(
    tmp_path: Path, robot: list[str], how: signal.Signals, turn: int
) -> None:
    with serving(tmp_path, *robot) as (process, port):
        process.send_signal(how)
        for _ in range(turn):  # impatiently
            process.send_signal(how)
        ends_cleanly(process, f"http://127.0.0.1:{port}")
    assert list(tmp_path.iterdir()) == []  # nothing uploaded is left


@pytest.mark.parametrize("after", [1, 10, 40])
def test_it_ends_cleanly_while_its_robot_is_dragged(tmp_path: Path, after: int) -> None:
    cloud = tmp_path / "cloud.xyz"
    np.savetxt(cloud, np.random.default_rng(0).uniform([0.2, -0.5, 0], [0.8, 0.5, 1], (20_000, 3)))
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    with serving(temporary, "panda", "--cloud", cloud, "--leaf", "0.01") as (process, port):
        assert process.stdout is not None
        assert process.stdout.readline() == f"http://127.0.0.1:{port}  (Ctrl-C ends it)\n"
        with dragged(port, "/targets/panda_link8") as answers_to_drags:
            while answers_to_drags.get(timeout=PATIENCE) < after:
                assert process.poll() is None
            process.send_signal(signal.SIGINT)
            said, complaints = process.communicate(timeout=PATIENCE)
    assert (process.returncode, said, complaints) == (0, "", "")
    assert list(temporary.iterdir()) == []


@contextmanager
def dragged(port: int, gizmo: str) -> Iterator["SimpleQueue[int]"]:
    """A page on which a gizmo goes round until the server is gone; counts what came of it."""
    drawn: SimpleQueue[int] = SimpleQueue()
    protocol = f"viser-v{viser.__version__}"

    def drag(page: Any) -> None:
        with suppress(ConnectionClosed):
            for count in itertools.count():
                x, y = 0.4 + 0.1 * math.cos(count), 0.1 * math.sin(count)
                page.send(
                    msgspec.msgpack.encode(
                        {
                            "type": "TransformControlsUpdateMessage",
                            "name": gizmo,
                            "wxyz": (0.0, 1.0, 0.0, 0.0),
                            "position": (x, y, 0.4),
                            "owner": "",
                        }
                    )
                )
                page.recv()
                drawn.put(count)

    with websockets.connect(f"ws://127.0.0.1:{port}", subprotocols=[protocol]) as page:
        hand = threading.Thread(target=drag, args=(page,))
        hand.start()
        yield drawn
        hand.join()
