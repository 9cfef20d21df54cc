"""Do the columns say what the part in the simulation does?"""

from __future__ import annotations

from itertools import islice

import numpy as np

from pdoik.errors import PdoikError
from pdoik.recordings import FloatArray

from ..motion import Balances, Key
from .outcome import Outcome, at_most, not_applicable
from .trial import Trial

COLUMNS = "columns against simulation"
LIMIT = 0.1  # of the columns' rms; a wrong sign leaves 2, a factor of two 0.5 or 1
LIMIT_SHOWN_POORLY = 0.8  # of effects that say so themselves: the sign and the size are theirs
_SETTLED = 0.7  # [s]
_LEAST = 3.0  # times what the arm without the effect leaves, or the example is too small


def against_simulation(trial: Trial) -> Outcome:
    """Residual of the simulated log less columns times coefficients, by the columns' rms.

    Over every balance that the log has, each by the size of what it balances: a channel that the
    columns forget counts as well.
    """
    effect, place = trial.effect, trial.place
    if place is None:
        return not_applicable(COLUMNS, "it has no place on the arm: give its example one")
    if not trial.parts:
        why = "it has no part in a simulation"
        if not trial.plain.compute(effect, place, trial.shape):
            why = "it acts in a log only and adds to no balance: it is found before any fit"
        return not_applicable(COLUMNS, why)
    try:
        with_effect = trial.balances
    except (PdoikError, ValueError) as error:
        return at_most(COLUMNS, np.inf, LIMIT, f"it cannot be simulated: {error}")
    columns = with_effect.compute(effect, place, trial.shape)
    if not columns:
        why = "it has a part in the simulation, and columns that are zero along the arm's motion"
        return at_most(COLUMNS, np.inf, LIMIT, why)
    said = {key: column @ trial.beta for key, column in columns.items()}
    scales = {key: _scale(with_effect, key) for key in with_effect.keys}
    size = _rms(with_effect, said, scales)
    plain = _without_others(trial, trial.plain)
    logged = _without_others(trial, with_effect)
    left = _rms(
        with_effect,
        {key: y - said.get(key, 0.0) for key, y in logged.items()},
        scales,
    )
    floor = _rms(trial.plain, plain, scales)
    limit = LIMIT_SHOWN_POORLY if effect.shown_poorly else LIMIT
    if size < _LEAST * floor:
        return at_most(
            COLUMNS, np.inf, limit, "the example's figures are too small to show: make them larger"
        )
    words = f"left of {', '.join(_words(key) for key in islice(said, 3))}"
    if effect.shown_poorly:
        words += "; its columns show it poorly by its own word, so only sign and size are asked"
    return at_most(COLUMNS, left / size, limit, words)


def _without_others(trial: Trial, b: Balances) -> dict[Key, FloatArray]:
    """The residual less the example's other effects, (N,) by key."""
    left = dict(b.residual)
    for other, shape, beta in trial.others:
        assert trial.place is not None
        for key, column in b.compute(other, trial.place, shape).items():
            left[key] = left[key] - column @ beta
    return left


def _scale(b: Balances, key: Key) -> float:
    """What errors of a balance are divided by: its own size, so that metres and N m add up."""
    motion = b.motions[0]
    balance = key[0]
    if balance in ("torque", "drive", "law"):
        return float(np.sqrt(np.mean(motion.tau**2)))
    if balance == "velocity":
        return float(np.sqrt(np.mean(motion.dq**2)))
    return 0.3  # of a pose: metres and radians of an arm of this size


def _rms(b: Balances, values: dict[Key, FloatArray], scales: dict[Key, float]) -> float:
    total = 0.0
    for key, each in values.items():
        rows = b.mask[key] & (b.time > _SETTLED)
        if rows.any():
            total += float(np.mean((each[rows] / scales[key]) ** 2))
    return float(np.sqrt(total))


def _words(key: Key) -> str:
    return f"{key[0]} {key[1] + 1}"
