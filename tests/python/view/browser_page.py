"""A page of pdoik view in Chromium, for tests that use it as a person does."""

import io
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import numpy as np
import pytest
from PIL import Image

from pdoik.view import Session

pytest.importorskip("viser", reason="pip install 'pdoik[view]'")
playwright = pytest.importorskip("playwright.sync_api", reason="pip install 'pdoik[test]'")
CHROMIUM = shutil.which("chromium")
if CHROMIUM is None:
    pytest.skip("apt-get install chromium", allow_module_level=True)

from pdoik.view.drawing.gizmos import Gizmo  # noqa: E402
from pdoik.view.examples import Example  # noqa: E402  # these need viser
from pdoik.view.model import shipped_model  # noqa: E402
from pdoik.view.server import start_server  # noqa: E402
from pdoik.view.viewer import Viewer  # noqa: E402

FLAGS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
WIDTH, HEIGHT = 1000, 540  # the panel hides nothing of the robot
PATIENCE = 120.0  # [s], with software rendering on a busy machine


class Page:
    """A viewer, its page in Chromium, and everything the page complained of or asked for."""

    def __init__(self, viewer: Viewer, page: Any) -> None:
        self.viewer = viewer
        self.page = page
        self.complaints: list[str] = []
        self.addresses: list[str] = []
        page.on("console", self._heard)
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", lambda request: self.addresses.append(request.url))
        page.on("websocket", lambda socket: self.addresses.append(socket.url))
        page.goto(viewer.server.url)
        self.wait(lambda: bool(viewer.server.get_clients()), "a client")
        page.locator("canvas").first.wait_for(timeout=1e3 * PATIENCE)
        page.get_by_text("worst constraint").wait_for(timeout=1e3 * PATIENCE)

    def _heard(self, message: Any) -> None:
        if message.type == "error":
            self.complaints.append(message.text)

    def wait(self, condition: Callable[[], bool], what: str) -> None:
        """Until it holds, with the page alive."""
        deadline = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < deadline, f"waited in vain for {what}"
            self.page.wait_for_timeout(50)

    @property
    def q(self) -> np.ndarray[Any, np.dtype[np.float64]]:
        return self.viewer.session.q

    def pixel(self, point: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
        """Where a point of the base frame is on the page, (2,)."""
        camera = next(iter(self.viewer.server.get_clients().values())).camera
        forward = camera.look_at - camera.position
        forward /= np.linalg.norm(forward)
        right = np.cross(forward, camera.up_direction)
        right /= np.linalg.norm(right)
        offset = point - camera.position
        box = self.page.locator("canvas").first.bounding_box()
        width, height = box["width"], box["height"]
        focal = height / 2 / np.tan(camera.fov / 2)  # fov is the vertical one
        across = np.array([offset @ right, -offset @ np.cross(right, forward)])
        middle = np.array([box["x"] + width / 2, box["y"] + height / 2])
        return middle + focal * across / (offset @ forward)

    def shot(self) -> np.ndarray[Any, np.dtype[np.int_]]:
        """The colours of the page, (HEIGHT, WIDTH, 3)."""
        image = Image.open(io.BytesIO(self.page.screenshot())).convert("RGB")
        return np.asarray(image, dtype=int)

    def around(self, xy: np.ndarray[Any, Any]) -> np.ndarray[Any, np.dtype[np.int_]]:
        """The colours about a pixel, (17, 17, 3)."""
        x, y = xy.astype(int)
        return self.shot()[y - 8 : y + 9, x - 8 : x + 9]

    def is_yellow(self, xy: np.ndarray[Any, Any]) -> bool:
        """Whether anything about a pixel is, as an arrow that a press would grip."""
        red, green, blue = np.moveaxis(self.around(xy), -1, 0)
        return bool((np.minimum(red, green) - blue).max() > 50)

    def drag(self, gizmo: Gizmo, axis: int, pixels: float) -> None:
        """Press on an arrow's head, move along the arrow, release."""
        T = gizmo.pose
        mouse = self.page.mouse
        grip = self.pixel(T[:3, 3] + 0.85 * gizmo.scale * T[:3, axis])
        way = grip - self.pixel(T[:3, 3])
        way *= pixels / np.linalg.norm(way)

        def is_lit() -> bool:  # an arrow sees a mouse that moves, and is drawn by then
            mouse.move(*(grip + 1))
            mouse.move(*grip)
            return self.is_yellow(grip)

        self.wait(is_lit, f"{gizmo.name}'s arrow to see the mouse")
        mouse.down()
        for share in np.linspace(0, 1, 8)[1:]:
            mouse.move(*(grip + share * way))
            self.page.wait_for_timeout(30)
        mouse.up()
        self.wait(lambda: not np.array_equal(gizmo.pose, T), f"{gizmo.name} to be dragged")
        self.page.wait_for_timeout(500)  # the last pose is on its way

    def upload(self, button: str, file: Path) -> None:
        with self.page.expect_file_chooser(timeout=1e3 * PATIENCE) as chooser:
            self.page.get_by_role("button", name=button).click()
        chooser.value.set_files(file)

    def settled(self) -> None:
        """Until the solver has granted the last wish."""
        session = self.viewer.session
        self.wait(lambda: session._wish == session._granted, "the solver")
        self.page.wait_for_timeout(300)


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield browser
        browser.close()


@contextmanager
def page_of(
    browser: Any,
    session: Session,
    example: Example | None = None,
    window: tuple[int, int] = (WIDTH, HEIGHT),
) -> Iterator[Page]:
    """A page that must stay quiet, and ask nothing of anything but this machine."""
    server = start_server("127.0.0.1", 0)
    viewer = Viewer(server, shipped_model(session.robot), session, example)
    tab = browser.new_page(viewport={"width": window[0], "height": window[1]})
    tab.set_default_timeout(1e3 * PATIENCE)
    try:
        page = Page(viewer, tab)
        yield page
        assert page.complaints == []
        hosts = {urlsplit(address.removeprefix("blob:")).hostname for address in page.addresses}
        assert hosts == {"127.0.0.1"}, page.addresses
        assert any(address.startswith("ws:") for address in page.addresses)
    finally:
        tab.close()
        viewer.close()
        server.stop()
