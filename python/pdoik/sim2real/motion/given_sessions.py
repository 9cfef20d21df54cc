"""The sessions that a study gives, such as days."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..study import Setup


def given_sessions(setups: Sequence[Setup]) -> NDArray[np.intp] | None:
    """Number of each recording's session, (recordings,); None where fewer than two are given.

    Recordings without a session in the study are of one session.
    """
    labels = list(dict.fromkeys(setup.session for setup in setups))
    if len(labels) < 2:
        return None
    return np.array([labels.index(setup.session) for setup in setups], dtype=np.intp)
