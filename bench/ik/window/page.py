"""The page of `pdoik view` in headless Chromium, for the README's pictures."""

import io
import shutil
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

from PIL import Image
from playwright.sync_api import Page, sync_playwright

from bench.common.arrays import FloatArray
from pdoik.view import Session
from pdoik.view.examples import Example
from pdoik.view.model import Model
from pdoik.view.server import start_server
from pdoik.view.viewer import Viewer

FLAGS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
]

_FRAMES = """n => new Promise(done => {
    const next = () => n-- > 0 ? requestAnimationFrame(next) : done();
    next();
})"""


@contextmanager
def running(make: Callable[[Any], Any]) -> Iterator[Any]:
    """A viewer on a port of its own."""
    server = start_server("127.0.0.1", 0)
    viewer = make(server)
    try:
        yield viewer
    finally:
        viewer.close()
        server.stop()


def served(
    model: Model, session: Session, example: Example | None = None
) -> AbstractContextManager[Viewer]:
    """The viewer of a session."""
    return running(lambda server: Viewer(server, model, session, example))


@contextmanager
def opened(viewer: Any, width: int = 1440, height: int = 900) -> Iterator[Page]:
    """The viewer's page, with a first answer on it and nothing in front of it; sizes in pixels."""
    chromium = shutil.which("chromium")
    with (
        sync_playwright() as driver,
        driver.chromium.launch(executable_path=chromium, args=FLAGS) as browser,
    ):
        page = browser.new_page(viewport={"width": width, "height": height})
        page.set_default_timeout(120_000)  # software rendering on a busy machine
        page.goto(viewer.server.url)
        page.get_by_text("worst constraint").or_(page.get_by_text("rms over")).first.wait_for()
        drawn(page)
        for button in page.locator(".mantine-Notification-closeButton").all():
            button.click()  # about software rendering
        yield page


def drag(viewer: Viewer, tip: str, poses: Iterable[FloatArray]) -> None:
    """Move a tip's target, 60 poses a second, (4, 4) each."""
    for T in poses:
        viewer.targets.by_tip[tip].place(T)
        viewer.session.set_target(tip, T)
        viewer.worker.wake()
        time.sleep(1 / 60)


def drawn(page: Page, frames: int = 12) -> None:
    """Wait until it has drawn so many pictures: software rendering trails behind."""
    page.evaluate(_FRAMES, frames)


def shoot(page: Page, out: Path) -> None:
    """Take the picture once all is drawn; colours in steps of 8 compress better."""
    drawn(page)
    steps = [255 if v > 251 else round(v / 8) * 8 for v in range(256)]
    with Image.open(io.BytesIO(page.screenshot(timeout=120_000))) as image:
        image.convert("RGB").point(3 * steps).save(out, optimize=True)
