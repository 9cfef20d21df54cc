"""What keeps an effect from being seen: channels that were not logged, motion that was not made.

Which channels an effect needs is asked of the effect itself: stand-ins for what was not logged are
put into a piece of a recording, one and two at a time, until its columns change a balance.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from pdoik.recordings import Recording

from ..effects import Effect
from ..motion import Balances, Motion, Place, Prepared, Shape, motions_of, thinned
from ..study import Controller, Payload, Study, part
from .joints import reversals
from .sizes import Size

_PIECE = 6.0  # of a recording that stand-ins are put into [s]
_AT_ONCE = 2  # channels that are asked for together, at most
_SENSED = {
    "channels": "no size is predicted: channels are compared with those of the other joints",
    "windows": "no size is predicted: a single event is found by its own window",
}


@dataclass(frozen=True, kw_only=True, eq=False)
class _Piece:
    """A piece of a recording with the study around it."""

    study: Study
    recording: Recording


class Missing:
    """Why effects of a study cannot be seen; its channels must be as they should be."""

    def __init__(self, prepared: Prepared) -> None:
        """Uses the recordings to fit."""
        self._prepared = prepared
        self._pieces: dict[tuple[str, ...], Balances | None] = {}
        run = thinned(prepared.study.fit[0])
        middle, half = len(run.time) // 2, round(0.5 * _PIECE / run.period)
        self._piece = part(run, max(middle - half, 0), min(middle + half, len(run.time)))

    def places(self, effect: Effect) -> list[Place]:
        """Where the effect may sit; () where channels are missing for it to be anywhere."""
        if effect.sought in _SENSED:
            return []
        return effect.places(self._prepared.fit.motions)

    def motion(self, effect: Effect, place: Place) -> str:
        """Why no motion shows it there, in words; "" where one may."""
        balances, joints = self._prepared.fit, self._prepared.study.joints
        for j in place.joints:
            if not effect.per_joint_moving or balances.excited[j]:
                continue
            return f"{joints[j]} moves too little"
        return ""

    def reason(self, effect: Effect, place: Place | None) -> str:
        """Which channels it needs, in words."""
        if effect.sought in _SENSED:
            return _SENSED[effect.sought]
        missing = [name for name, (has, _) in _STAND_INS.items() if not has(self._prepared)]
        for count in range(1, _AT_ONCE + 1):
            enough = [
                names
                for names in combinations(missing, count)
                if self._is_seen(effect, place, names)
            ]
            if enough:
                said = [" and ".join(_WORDS[name] for name in names) for names in enough]
                return f"needs {' or '.join(said)}"
        if self._prepared.study.robot is None:
            effort = self._prepared.fit.motions[0].source or "a torque (tau, current or tau_cmd)"
            return f"needs the robot's description, besides {effort}"
        return "changes nothing that was recorded"

    def hidden(self, effect: Effect, size: Size) -> str:
        """What looks like it along these motions, in words."""
        balances, joints = self._prepared.fit, self._prepared.study.joints
        for j in size.place.joints:
            turns = sum(reversals(m, j) for m in balances.motions)
            if effect.family == "friction" and turns == 0:
                return f"{joints[j]} never reverses"
        if size.left < self._prepared.study.thresholds.diagnosis.little:
            return "looks like friction, offsets or bodies along these motions"
        return "not seen at any size that is tried"

    def _is_seen(self, effect: Effect, place: Place | None, names: tuple[str, ...]) -> bool:
        balances = self._with(names)
        if balances is None:
            return False
        places = effect.places(balances.motions)
        at = place if place in places else next(iter(places), None)
        if at is None:
            return False
        return any(
            balances.compute(effect, at, shape)
            for shape in self._shapes(effect, balances.motions, at)
        )

    def _shapes(self, effect: Effect, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Shapes of an effect with an amount that does something."""
        found = []
        for shape in effect.asked(motions, place):
            try:
                found.append(effect.of_amount(_LITTLE, motions, place, shape, 1)[0])
            except ValueError:  # of several coefficients
                found.append(shape)
        return found

    def _with(self, names: tuple[str, ...]) -> Balances | None:
        """Balances of the piece with stand-ins."""
        if names not in self._pieces:
            piece = _Piece(study=self._prepared.study, recording=self._piece)
            for name in names:
                piece = _STAND_INS[name][1](piece, self._prepared)
            body = self._prepared.body
            noise = np.full(len(piece.study.joints), 1e-12)
            motions = motions_of(piece.study, [piece.recording], body, self._prepared.cutoff, noise)
            self._pieces[names] = Balances(motions, piece.study.thresholds)
        return self._pieces[names]


_LITTLE = 0.02


def _channel(name: str) -> Callable[[_Piece, Prepared], _Piece]:
    """A channel filled with something like it."""

    def filled(piece: _Piece, prepared: Prepared) -> _Piece:
        run = piece.recording
        like = run.dq if name == "dq" and run.dq is not None else run.q
        turned = like + 0.01 * np.sin(7.0 * run.time)[:, None]
        return replace(piece, recording=replace(run, **{name: turned}))  # type: ignore[arg-type]

    return filled


def _gains(piece: _Piece, prepared: Prepared) -> _Piece:
    n = len(piece.study.joints)
    known = Controller(kp=np.full(n, 100.0), kd=np.full(n, 10.0))
    return replace(piece, study=replace(piece.study, controller=known))


def _tip(piece: _Piece, prepared: Prepared) -> _Piece:
    still = np.tile([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], (len(piece.recording.time), 1))
    return replace(piece, recording=replace(piece.recording, tip=still))


def _payload(piece: _Piece, prepared: Prepared) -> _Piece:
    body, run = prepared.body, piece.recording
    if body is None:
        return piece
    held = Payload(link=body.links[body.last], mass=1.0, com=(0.05, 0.0, 0.0))
    setup = replace(piece.study.setup_of(run), payload=held)
    setups = {**piece.study.setups, run.file or run.name: setup}
    return replace(piece, study=replace(piece.study, setups=setups))


def _logged(*names: str) -> Callable[[Prepared], bool]:
    def has(prepared: Prepared) -> bool:
        runs = prepared.study.fit
        return all(any(name in run.channels for name in names) for run in runs)

    return has


_STAND_INS: dict[str, tuple[Callable[[Prepared], bool], Callable[[_Piece, Prepared], _Piece]]] = {
    "tau": (_logged("tau", "current"), _channel("tau")),
    "tau_cmd": (_logged("tau_cmd"), _channel("tau_cmd")),
    "q_des": (_logged("q_des"), _channel("q_des")),
    "gains": (lambda prepared: prepared.study.controller is not None, _gains),
    "dq": (_logged("dq"), _channel("dq")),
    "tip": (_logged("tip"), _tip),
    "payload": (
        lambda prepared: any(each.payload for each in prepared.study.setups.values()),
        _payload,
    ),
}
"""Whether a study has something, and how something like it is put into a piece of a recording."""

_WORDS = {
    "tau": "tau (or current)",
    "tau_cmd": "tau_cmd",
    "q_des": "q_des",
    "gains": "the controller's gains",
    "dq": "dq",
    "tip": "tip poses",
    "payload": "a recording with a known payload",
}
