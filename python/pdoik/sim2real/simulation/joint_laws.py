"""The torque laws of all joints, evaluated once a step."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from pdoik.recordings import FloatArray

from .assemble import play_name
from .description import nearest
from .parts import GearPlay, HardFriction, JointTorque, Law, Part, StatefulLaw
from .plant import SOLVED_IN, Plant


class JointLaws:
    """Laws with their memories, friction whose level varies, and springs behind play."""

    def __init__(self, plant: Plant, parts: tuple[Part, ...]) -> None:
        self._plant, self._parts, self._model = plant, parts, plant.model
        self._resting_friction: FloatArray = plant.model.dof_frictionloss.copy()
        self.start = 0.0  # of what is simulated, on the study's clock [s]
        self.forget()

    def forget(self) -> None:
        """Reset everything to the state before anything happened."""
        plant = self._plant
        self._load = [0.0] * len(plant.joints)
        self._at_link = [0.0] * len(plant.joints)  # torques beyond the gear
        self._torques: list[tuple[int, int, bool, bool, Law | StatefulLaw]] = []
        self._levels: dict[int, list[Law]] = {}
        self.memories: list[tuple[int, StatefulLaw]] = []
        loaded = set()
        for part in self._parts:
            if not isinstance(part, JointTorque | HardFriction):
                continue
            k = self._place(part.joint)
            if part.needs_load:
                loaded.add(k)
            if isinstance(part, HardFriction):
                if callable(part.level):
                    self._levels.setdefault(k, []).append(part.level)
                continue
            source, law = self._place(part.of or part.joint), part.law
            if isinstance(law, StatefulLaw):
                law = law.fresh()
                self.memories.append((source, law))
            self._torques.append((k, source, part.at_link, part.by_clock, law))
        self.loaded = sorted(loaded)
        self._springs = [
            (play, gear)
            for k, gear in plant.gears.items()
            if not gear.waves
            if (play := plant.play[k]) is not None and gear.gap and np.isfinite(gear.stiffness)
        ]
        self._waves = [(k, gear) for k, gear in plant.gears.items() if gear.waves]
        self.none = not (self._torques or self._levels or self._springs or self._waves or loaded)

    def _place(self, joint: str) -> int:
        return self._plant.joints.index(nearest(joint, self._plant.joints, "joint"))

    def longest_step(self, longest: float) -> float:
        """The longest step, at most `longest`, that the stiffest law and spring allow [s]."""
        fastest = 0.0
        if self.memories:
            own = np.diag(self._plant.inverse_inertia(np.zeros(len(self._plant.joints))))
            fastest = max((own[k] * abs(law.stiffness)) ** 0.5 for k, law in self.memories)
        return self._plant.longest_step(longest, fastest)

    def apply(self, t: float, q: list[float], v: list[float], applied: list[float]) -> None:
        """Take the laws' torques off what is applied to the degrees of freedom."""
        dofs, plays, loads = self._plant.dof, self._plant.play, self._load
        if self.loaded:
            self._at_link = [0.0] * len(dofs)
        for k, source, at_link, by_clock, law in self._torques:
            now = t + self.start if by_clock else t
            dof, other = dofs[k], dofs[source]
            play = plays[source] if at_link else None
            if play is None:
                torque = law(now, q[other], v[other], loads[k])
            else:
                torque = law(now, q[other] + q[play], v[other] + v[play], loads[k])
            applied[dof] -= torque
            if at_link:
                self._at_link[k] += torque
                play = plays[k]
                if play is not None:
                    applied[play] -= torque
        friction: Any = self._model.dof_frictionloss
        for k, laws in self._levels.items():
            dof = dofs[k]
            level = float(self._resting_friction[dof])
            for law in laws:
                level += law(t, q[dof], v[dof], loads[k])
            friction[dof] = level if level > 0.0 else 0.0
        for play, gear in self._springs:
            half, twist = gear.gap / 2, q[play]
            beyond = twist - half if twist > half else twist + half if twist < -half else 0.0
            applied[play] -= gear.stiffness * beyond
        for k, gear in self._waves:
            self._put_further(k, gear, q, v, applied)

    def _put_further(
        self, k: int, gear: GearPlay, q: list[float], v: list[float], applied: list[float]
    ) -> None:
        """Let a link be where its gear's waves put it, and the motor feel the slope."""
        model, dof, play = self._model, self._plant.dof[k], self._plant.play[k]
        assert play is not None
        value, slope, curvature = gear.error(q[dof])
        half = gear.gap / 2
        if gear.is_rigid:
            # MuJoCo leaves the curvature out of what the constraint asks of accelerations: the
            # place asked for is ahead by what its spring makes up for that.
            ahead = curvature * v[dof] ** 2 * (SOLVED_IN * float(model.opt.timestep)) ** 2
            tie = model.equality(play_name(gear.joint)).id
            model.eq_data[tie, :2] = value - slope * q[dof] + ahead, slope
        elif math.isinf(gear.stiffness):
            model.jnt_range[play] = value - half, value + half
        else:
            twist = q[play] - value
            beyond = twist - half if twist > half else twist + half if twist < -half else 0.0
            applied[play] -= gear.stiffness * (beyond if half else -value)
            applied[dof] += gear.stiffness * beyond * slope

    def feel_load(
        self, applied: list[float], v: list[float], friction: list[float], ddq: list[float]
    ) -> None:
        """Torques through the gears: the motors' less their friction and rotors' inertia."""
        model = self._model
        for k in self.loaded:
            dof = self._plant.dof[k]
            self._load[k] = (
                applied[dof]
                + self._at_link[k]
                + friction[dof]
                - float(model.dof_damping[dof]) * v[dof]
                - float(model.dof_armature[dof]) * ddq[dof]
            )

    def remember(self, q: list[float], v: list[float], dt: float) -> None:
        """Let memories go on to the step's end."""
        for k, law in self.memories:
            dof = self._plant.dof[k]
            law.advance(q[dof], v[dof], dt)
