"""Which of several windows of time a contact is looked for in."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("pinocchio")

from pdoik.sim2real.identify import Window, clearest


def window(link: int, gain: float) -> Window:
    return Window(motion=0, link=link, shape=(), begin=1.0, end=2.0, gain=gain)


def test_windows_that_cost_more_than_they_explain_are_no_contacts() -> None:
    assert clearest([]) is None
    assert clearest([window(3, -4.0), window(2, -np.inf)]) is None
    assert clearest([window(3, -np.inf)]) is None


def test_of_links_that_explain_alike_the_one_nearest_the_base_is_taken() -> None:
    windows = [window(4, 50.0), window(3, 100.0), window(2, 99.0), window(1, 60.0)]
    assert clearest(windows) is windows[2]
    assert clearest([window(2, -np.inf), window(1, 5.0)]).gain == 5.0
