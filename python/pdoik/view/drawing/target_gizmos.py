"""What targets are dragged by, and which of several is met."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import viser

from ..goals import TipGoal
from ..shown import Shown
from .gizmos import Gizmo

FloatArray = npt.NDArray[np.float64]

_MET, _MISSED, _OTHER = (27, 127, 59), (211, 21, 27), (148, 156, 168)


class TargetGizmos:
    """Gizmos for each tip link that is not free, below /targets.

    Args:
        server: Where to draw.
        goals: Of each tip.
        scale: Of the arrows [m].
        on_drag: Called with the tip, the pose, and which of the tip's targets it is.

    Attributes:
        by_tip: Of each tip's first target.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        goals: Mapping[str, TipGoal],
        scale: float,
        on_drag: Callable[[str, FloatArray, int], None],
    ) -> None:
        self._server, self._scale, self._on_drag = server, scale, on_drag
        self.by_tip = {tip: self._add(tip, goal.targets[0], 0) for tip, goal in goals.items()}
        self._others: dict[str, list[Gizmo]] = {tip: [] for tip in goals}
        self._marks: dict[str, list[tuple[Any, Any]]] = {tip: [] for tip in goals}
        self.follow(goals)

    def all_of(self, tip: str) -> list[Gizmo]:
        return [self.by_tip[tip], *self._others[tip]]

    def show(self, shown: Shown) -> None:
        """Jump to the tips where the posture was given; a dragged gizmo is not touched."""
        for tip, goal in shown.goals.items():
            if shown.origin in ("joints", "log") or goal.kind == "free":
                for gizmo, T in zip(self.all_of(tip), goal.targets, strict=False):
                    gizmo.place(T)
            for k, (ball, label) in enumerate(self._marks[tip]):
                color, text = _OTHER, f"goal {k + 1}"
                if k == shown.met[tip]:
                    color = _MET if shown.met_to_tolerance else _MISSED
                    text += ", met" if shown.met_to_tolerance else ", missed"
                if label.text != text:
                    ball.color, label.text = color, text

    def follow(self, goals: Mapping[str, TipGoal]) -> None:
        """Show as many as there are targets; free tips have nothing to drag, positions no arcs."""
        for tip, goal in goals.items():
            others = self._others[tip]
            if len(self._marks[tip]) != _marks_of(goal):
                self._unmark(tip)  # before what they are below goes
            while len(others) + 1 > len(goal.targets):
                others.pop().remove()
            while len(others) + 1 < len(goal.targets):
                k = len(others) + 1
                others.append(self._add(tip, goal.targets[k], k))
            for gizmo in self.all_of(tip):
                gizmo.show(goal.kind != "free")
                gizmo.turn(goal.kind not in ("position", "look_at"))
            if not self._marks[tip]:
                self._mark(tip, _marks_of(goal))

    def place(self, goals: Mapping[str, TipGoal], tip: str) -> None:
        """Put a tip's gizmos where its targets are."""
        for gizmo, T in zip(self.all_of(tip), goals[tip].targets, strict=False):
            gizmo.place(T)

    def remove(self) -> None:
        for tip in self.by_tip:
            self._unmark(tip)
            for gizmo in self.all_of(tip):
                gizmo.remove()

    def _add(self, tip: str, T: FloatArray, which: int) -> Gizmo:
        return Gizmo(
            self._server,
            f"/targets/{tip.replace('/', '_')}" + (f" {which + 1}" if which else ""),
            T,
            self._scale,
            lambda T: self._on_drag(tip, T, which),
        )

    def _mark(self, tip: str, count: int) -> None:
        """A ball and a number at each of several targets."""
        scene = self._server.scene
        for gizmo in self.all_of(tip)[:count]:
            ball = scene.add_icosphere(f"{gizmo.name}/met", radius=0.13 * self._scale, color=_OTHER)
            label = scene.add_label(f"{gizmo.name}/number", "", anchor="bottom-left")
            self._marks[tip].append((ball, label))

    def _unmark(self, tip: str) -> None:
        for nodes in self._marks[tip]:
            for node in nodes:
                node.remove()
        self._marks[tip] = []


def _marks_of(goal: TipGoal) -> int:
    return len(goal.targets) if len(goal.targets) > 1 else 0
