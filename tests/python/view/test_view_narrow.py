"""pdoik view on a telephone and on a tablet: the picture above, all of the panel below it."""

from typing import Any

import numpy as np
import pytest

from browser_page import PATIENCE, Page, browser, page_of
from pdoik.view.examples import EXAMPLES

__all__ = ["browser"]  # a fixture

TIP = "panda_link8"
WINDOWS = [(390, 844), (768, 1024)]
TABS = ("Solve", "Joints", "Replay", "Reach", "Files")
PANEL = ".mantine-Paper-root:has(.pdoik-panel)"
# Of the controls of the open tab the lowest one: its middle, and whether the mouse would meet it.
LOWEST = """panel => {
  const controls = [...panel.querySelectorAll("input, button, textarea, [role=slider]")];
  const seen = controls.filter(each => each.getClientRects().length);
  const low = seen.reduce((a, b) =>
    a.getBoundingClientRect().bottom > b.getBoundingClientRect().bottom ? a : b);
  const box = low.getBoundingClientRect();
  const x = box.x + box.width / 2, y = box.y + box.height / 2;
  const met = document.elementFromPoint(x, y);
  return {x, y, met: !!met && (low.contains(met) || met.contains(low) ||
                               met.parentElement.contains(low))};
}"""


def share_of_picture(page: Page, window: tuple[int, int]) -> float:
    box = page.page.locator("canvas").first.bounding_box()
    assert box["x"] == box["y"] == 0
    return float(box["width"] * box["height"] / (window[0] * window[1]))


@pytest.mark.parametrize("window", WINDOWS)
def test_the_picture_is_half_of_a_narrow_window_and_all_of_the_panel_is_below_it(
    browser: Any, window: tuple[int, int]
) -> None:
    _, session = EXAMPLES[0].make()
    with page_of(browser, session, EXAMPLES[0], window=window) as page:
        width, height = window
        page.wait(lambda: 0.5 <= share_of_picture(page, window) < 0.6, "the picture")
        page.settled()
        panel = page.page.locator(PANEL).first
        box, canvas = panel.bounding_box(), page.page.locator("canvas").first.bounding_box()
        assert box["y"] >= canvas["y"] + canvas["height"] - 1  # not over it
        assert (box["x"], box["width"]) == (0, width)  # nor beside it
        assert box["y"] + box["height"] <= height + 1

        for tab in TABS:
            page.page.get_by_role("tab", name=tab, exact=True).click()
            page.page.mouse.move(width / 2, 0.9 * height)

            def at_the_end() -> bool:
                page.page.mouse.wheel(0, 400)
                page.page.wait_for_timeout(150)
                lowest = panel.evaluate(LOWEST)
                inside = 0 < lowest["x"] < width and box["y"] < lowest["y"] < height
                return bool(inside and lowest["met"])

            page.wait(at_the_end, f"the end of {tab}")
            assert page.page.evaluate("document.scrollingElement.scrollWidth") <= width
            page.page.mouse.wheel(0, -1e5)
            page.page.get_by_role("tab", name=tab, exact=True).wait_for(timeout=1e3 * PATIENCE)


@pytest.mark.parametrize("window", WINDOWS)
def test_on_a_narrow_window_the_hand_is_dragged_and_the_panel_folds_away(
    browser: Any, window: tuple[int, int]
) -> None:
    _, session = EXAMPLES[0].make()
    with page_of(browser, session, EXAMPLES[0], window=window) as page:
        width, height = window
        words = page.page.get_by_text("worst constraint")
        page.settled()
        target = page.viewer.targets.by_tip[TIP]

        def is_seen() -> bool:
            x, y = page.pixel(session.targets[TIP][:3, 3])
            return bool(0.2 * width < x < 0.8 * width and 0.1 * height < y < 0.45 * height)

        page.wait(is_seen, "the camera")
        page.drag(target, axis=1, pixels=25)
        page.settled()
        reached = session.robot.fk(session.q)
        np.testing.assert_allclose(reached, session.targets[TIP], atol=5e-5)

        page.page.get_by_text("pdoik view", exact=True).click()
        page.wait(lambda: share_of_picture(page, window) > 0.99, "the whole window")
        page.page.get_by_text("pdoik view", exact=True).click()
        page.wait(
            lambda: share_of_picture(page, window) < 0.6 and words.is_visible(), "the panel again"
        )
