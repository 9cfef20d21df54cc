"""Friction that changes from session to session, taken off the balances before a second search.

Oil warms up and seals settle: friction differs between days by a tenth or more. What a mean leaves
of it in each session looks like other causes (a limit, a drift), which are then named. So each
session's difference from the mean is taken off, as far as its data tell it, and the search is made
again: what is found then is the same in all sessions.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..motion.place import Key
from ..motion.prepare import Prepared
from ..regression.session_changes import session_changes
from ..regression.trial import Search
from ..study.recording import FloatArray


def with_level_sessions(prepared: Prepared, state: Search) -> Prepared:
    """The study with friction in every session as it is on average; itself where it is anyway."""
    told = prepared.fit.told
    if told is None:
        return prepared
    off: dict[Key, FloatArray] = {}
    session = told[prepared.fit.recording]
    for each in session_changes(state.fit):
        for key, column in each.term.columns.items():
            part = np.sum(column * each.changes[session], axis=1)
            off[key] = off.get(key, np.zeros(len(part))) + part
    return replace(prepared, fit=prepared.fit.less(off)) if off else prepared
