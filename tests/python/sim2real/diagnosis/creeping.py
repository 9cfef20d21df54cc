"""First logs as operators make them: two recordings in which the arm hardly moves."""

from __future__ import annotations

import numpy as np

from bench.sim2real.concealed.draft import Draft
from bench.sim2real.frame.motion import STEP, Motion

SECONDS = 9.0


def creeping(draft: Draft) -> list[Motion]:
    """Slow sines of a tenth of a radian about the middle of a two-jointed arm's first motion."""
    time = STEP * np.arange(round(SECONDS / STEP))
    middle, motions = draft.motions[0].q.mean(axis=0), []
    for rate in (0.5, 0.7):
        turns = np.outer(time, rate * np.array([1.0, 1.3]))
        q, dq, ddq = (0.1 * rate**k * np.sin(turns + k * np.pi / 2) for k in range(3))
        motions.append(Motion(q=middle + q, dq=dq, ddq=ddq))
    return motions
