"""What the laws show of the drives behind them: one that answers late, one that is cut off."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pdoik.descriptions import robot_facts
from pdoik.recordings import Recording

from ..effects import CATALOGUE
from ..effects.drives import (
    OF_LAW,
    OF_POSITION,
    OF_TORQUE,
    ActuatorLag,
    CommandDelay,
    TorqueSaturation,
    TorqueSpeedLimit,
    kinds,
)
from ..findings import Equivalent, Estimate, Evidence, Finding, Support
from ..motion import Ceiling, Prepared, ceiling_of, pile_at
from ..regression import where_in_words
from . import cut_off, lateness
from .cut_off import CutOff
from .lateness import Late
from .linear_law import Gained, Strip, followed, strips_of
from .rows import Feeds, effort_of, pieces_of

Values = dict[str, tuple[float, float]]
"""Figures with their errors."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Drives:
    """Commands, motion and effort of every joint that has them, in the motion's band."""

    prepared: Prepared
    fit: dict[int, tuple[Strip, ...]]  # by joint
    judges: dict[int, tuple[Strip, ...]]

    @classmethod
    def of(
        cls,
        prepared: Prepared,
        fit: Sequence[Recording],
        judges: Sequence[Recording],
        feeds: Feeds,
    ) -> Drives:
        """The drives of a study's recordings, thinned."""
        return cls(
            prepared=prepared,
            fit=_strips(prepared, fit, feeds),
            judges=_strips(prepared, judges, feeds),
        )

    def followed(self, j: int) -> float:
        """Share of joint j's held-out effort that a law of any kind explains; 0 where unknown."""
        return followed(self.fit[j], self.judges.get(j, self.fit[j])) if j in self.fit else 0.0


def drive_findings(drives: Drives) -> tuple[Finding, ...]:
    """Findings of joints without a given controller, by commands, motion and effort alone."""
    prepared, judges = drives.prepared, drives.judges
    limits = prepared.study.thresholds.controllers
    late = {each.joint: each for each in lateness.later_ones(drives.fit, limits)}
    found = []
    for j in range(len(prepared.study.joints)):
        cut = _top(prepared, j) or (_cut(drives, j) if j in drives.fit else None)
        if cut is not None:
            found.append(cut)
            late.pop(j, None)  # what is cut off also comes late
    for j, each in late.items():
        judged = lateness.gained_by(each, judges[j]) if j in judges else None
        found.append(_stated(prepared, j, *_delayed(each), each.support, judged))
    return tuple(found)


def _strips(
    prepared: Prepared, logged: Sequence[Recording], feeds: Feeds
) -> dict[int, tuple[Strip, ...]]:
    """Strips by joint, of those whose effort and command were logged."""
    limits = prepared.study.thresholds.controllers
    found = {}
    for j in range(len(prepared.study.joints)):
        effort = effort_of(logged, j)
        pieces = pieces_of(logged, j, effort, feeds, limits) if effort else ()
        if sum(int(piece.use.sum()) for piece in pieces) >= limits.least_rows:
            found[j] = strips_of(pieces, prepared.cutoff, limits)
    return found


def _in_torque(prepared: Prepared, j: int) -> bool:
    """Whether joint j's effort is what the drive gave, as a torque."""
    study = prepared.study
    return effort_of((*study.fit, *study.validate), j) == "tau"


def _given(prepared: Prepared, j: int, level: float) -> bool:
    """Whether a level is the one that the robot's description has."""
    study = prepared.study
    if study.robot is None:
        return False
    facts = robot_facts(study.robot).joints.get(study.joints[j])
    return bool(
        facts and facts.effort and level > study.thresholds.controllers.as_given * facts.effort
    )


def _top(prepared: Prepared, j: int) -> Finding | None:
    """A ceiling that joint j's torques show by themselves, where nobody logged what was asked."""
    limits = prepared.study.thresholds.limits
    if kinds(prepared.fit.motions[0], j):
        return None
    top = ceiling_of(prepared.fit.motions, j, limits)
    if top is None or _given(prepared, j, top.level):
        return None
    judges = None if prepared.validate is None else prepared.validate.motions
    again = top.pile if judges is None else pile_at(top, judges, j, limits)
    if again is None:
        return None
    if again < limits.piled:  # what only judges must show it too, or it twice as clearly
        if top.pile < limits.piled**2:
            return None
        again = 1.0
    stands_out, judged = 1.0 - 1.0 / top.pile, 1.0 - 1.0 / again
    seen = Support(
        weight=stands_out,
        gain=stands_out,
        t=float(np.sqrt(top.occasions)),
        size=top.pile,
        agree=len(prepared.fit.motions),
        sessions=len(prepared.fit.motions),
        blocks=top.occasions,
        left=1.0,
        rivals=1,
    )
    return _stated(prepared, j, *_limited(top), seen, Evidence.once(judged, "tau"))


def _cut(drives: Drives, j: int) -> Finding | None:
    """The limit beyond which joint j gives less than its law asks for."""
    prepared, limits = drives.prepared, drives.prepared.study.thresholds.controllers
    cut = cut_off.cut_off(j, drives.fit[j], limits) if _in_torque(prepared, j) else None
    if cut is None or _given(prepared, j, cut.level):
        return None
    judged = cut_off.gained_by(cut, drives.judges[j], limits) if j in drives.judges else None
    return _stated(prepared, j, *_limited(cut), cut.support, judged)


def _limited(
    cut: CutOff | Ceiling,
) -> tuple[str, str, Values, tuple[str, tuple[float, ...]]]:
    """Name, the other name, figures, and of what it is: a level, or a line that falls."""
    values = {"level": (cut.level, cut.level_std)}
    effect, other = TorqueSaturation.id, TorqueSpeedLimit.id
    if np.isfinite(cut.no_load):
        effect, other = other, effect
        no_load = (cut.no_load, cut.no_load_std)
        values = {"stall_torque": values["level"], "no_load_speed": no_load}
    shape = (OF_LAW, *(value for value, _ in values.values()))
    return effect, other, values, ("law", shape)


def _delayed(late: Late) -> tuple[str, str, Values, tuple[str, tuple[float, ...]]]:
    """The same, over the others' time: that is in the log, not in the drive."""
    if late.of == "lag":
        figures = {"time_constant": (late.time, late.std)}
        return ActuatorLag.id, CommandDelay.id, figures, ("torque", (OF_TORQUE, late.time))
    figures = {"delay": (late.time, late.std)}
    return CommandDelay.id, ActuatorLag.id, figures, ("position", (OF_POSITION, late.time))


def _stated(
    prepared: Prepared,
    j: int,
    name: str,
    other: str,
    values: Values,
    of: tuple[str, tuple[float, ...]],
    support: Support,
    judged: Evidence | Gained | None,
) -> Finding:
    """What speaks for it where nothing was held out speaks for it elsewhere, too."""
    study = prepared.study
    channels = ("q_des", effort_of(study.fit, j))
    if judged is None:
        judged = Evidence.once(support.gain, *channels)
    elif isinstance(judged, Gained):
        judged = judged.evidence(channels)
    effect, joint = CATALOGUE[name], study.joints[j]
    where = where_in_words(effect.on, (joint,), ())
    plain = {key: value for key, (value, _) in values.items()}
    return Finding(
        effect=name,
        joints=(joint,),
        recordings=tuple(r.name for r in study.fit),
        regime=effect.regime(where),
        statement=effect.statement(where, plain),
        parameters={
            key: Estimate(
                value=value,
                std=std,
                interval95=(max(value - 1.96 * std, 0.0), value + 1.96 * std),
                unit=next(each.unit for each in effect.parameters if each.name == key),
            )
            for key, (value, std) in values.items()
        },
        equivalents=(Equivalent(effect=other, joints=(joint,)),),
        decided_by=effect.decided_by,
        evidence=judged,
        support=support,
        weight=support.weight,
        variant=of[0],
        shape=of[1],
    )
