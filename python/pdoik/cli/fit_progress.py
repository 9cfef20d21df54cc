"""How a fit of hulls goes on: a line for each link that is done, and a bar on a terminal."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rich.markup import escape
from rich.progress import Progress

from .messages import tell
from .story import share_bar

if TYPE_CHECKING:
    from pdoik.occupancy_fit import LinkNews


class FitStory:
    """What is reported of each link as `fit_occupancy` goes on."""

    def __init__(self, bar: Progress) -> None:
        self._bar = bar
        self._task = bar.add_task("hulls", total=1.0)
        self._begun: list[str] = []
        self._start: tuple[float, float] | None = None  # [s], and the share that was kept

    def __call__(self, news: LinkNews) -> None:
        """Take one link's news."""
        if news.state == "begun":
            self._begun.append(news.link)
            self._start = self._start or (time.monotonic(), news.share)
        else:
            self._begun = [link for link in self._begun if link != news.link]
            tell(f"{self._what(news)}; {news.done} of {news.links} links{self._left(news.share)}")
        doing = f"hulls of {', '.join(self._begun)}" if self._begun else "hulls"
        self._bar.update(self._task, description=escape(doing), completed=news.share)

    def _what(self, news: LinkNews) -> str:
        capsules = f"{news.n_capsules} capsules" if news.n_capsules != 1 else "1 capsule"
        how = {
            "fitted": f"fitted in {news.seconds:.1f} s",
            "kept": "kept from an earlier fit",
            "like": f"the same geometry as {news.like}",
        }[news.state]
        return f"{news.link}: {capsules}, {how}" if news.n_capsules else f"{news.link}: {how}"

    def _left(self, share: float) -> str:
        """Time left, in words, by the work done since the first link was begun."""
        if self._start is None or share >= 1.0 - 1e-9 or share <= self._start[1]:
            return ""
        begun, kept = self._start
        seconds = (time.monotonic() - begun) * (1.0 - share) / (share - kept)
        return f", about {seconds:.0f} s left"


@contextmanager
def fit_story() -> Iterator[FitStory]:
    """Progress report to give to a fit; the bar vanishes at the end."""
    with share_bar() as bar:
        yield FitStory(bar)
