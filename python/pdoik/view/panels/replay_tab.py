"""The tab that replays a log."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import viser

from ..drawing.shapes import wxyz_of
from ..humanoid import object_frame
from ..log import Log
from ..player import Player

if TYPE_CHECKING:
    from ..page import Page
    from ..session import Session

_SPEEDS = ("0.1", "0.25", "0.5", "1", "2", "5")


class ReplayTab:
    """Upload, play and pause, time, speed, the signal to pose by, and an object's marker."""

    def __init__(self, gui: viser.GuiApi, page: Page) -> None:
        self._page = page
        self._loaded: tuple[Log, Session] | None = None  # a log and the session of its robot
        self._marker: viser.FrameHandle | None = None
        self.player = Player(self.seek)
        self.upload = gui.add_upload_button("Log (.csv)", icon=viser.Icon.UPLOAD)
        self.upload.on_upload(lambda event: page.take_log(event.target.value))
        self.path = gui.add_upload_button(
            "Path (.csv .yaml)",
            icon=viser.Icon.UPLOAD,
            hint="Poses of the tool, or goals: the robot follows them as one motion",
            visible=page.read_path is not None,
        )
        self.path.on_upload(lambda event: page.take_path(event.target.value))
        self.again = gui.add_button(
            "Follow the path again",
            icon=viser.Icon.ROUTE,
            hint="Among the obstacles as they are now",
            visible=False,
        )
        self.again.on_click(lambda _: page.follow_again())
        self.play = gui.add_button("Play", icon=viser.Icon.PLAYER_PLAY, disabled=True)
        self.play.on_click(lambda _: self._toggle())
        self.time: Any = gui.add_slider("Time [s]", 0.0, 1.0, 0.001, 0.0, disabled=True)
        self.time.on_update(self._slid)
        self.speed = gui.add_dropdown("Speed", _SPEEDS, initial_value="1")
        self.speed.on_update(lambda _: self.player.set_speed(float(self.speed.value)))
        self.signal = gui.add_dropdown(
            "Signal",
            ("q", "q_des"),
            initial_value="q",
            hint="Measured or desired positions",
        )
        self.signal.on_update(lambda _: self.seek(self.player.elapsed))
        self.facts = gui.add_markdown("No log.")

    def load(self, log: Log) -> None:
        """Stand at the first row of a log."""
        self._loaded = log, self._page.session
        self.player.load(log.duration)
        self.signal.options = tuple(log.postures)
        self.time.max = max(log.duration, 1e-3)
        self.time.disabled = self.play.disabled = False
        self._drop_marker()
        if log.object_pose is not None:
            self._marker = self._page.server.scene.add_frame(
                "/object", axes_length=0.1, axes_radius=0.004
            )
            self._page.server.scene.add_icosphere(
                "/object/mesh", radius=0.03, color=(44, 160, 44), opacity=0.8
            )
        self.seek(0.0)

    def unload(self) -> None:
        """Forget the log: it was of another robot."""
        self.player.pause()
        self._loaded = None
        self._drop_marker()
        self.again.visible = False
        self.time.disabled = self.play.disabled = True
        self.facts.content = "No log."

    def seek(self, elapsed: float) -> None:
        """Pose the robot as it was, so many seconds after the first row."""
        if self._loaded is None:
            return
        log, session = self._loaded
        self.player.seek(elapsed)
        self.time.value = round(elapsed, 3)
        self.play.label = "Pause" if self.player.playing else "Play"
        session.set_posture(log.at(elapsed, self.signal.value), origin="log")
        self._page.worker.wake()
        self.facts.content = facts(log, elapsed, session.robot.joint_names)
        if self._marker is not None and log.object_pose is not None:
            T = object_frame(session.robot, session.q) @ log.object_pose[log.row(elapsed)]
            self._marker.wxyz, self._marker.position = wxyz_of(T[:3, :3]), T[:3, 3]

    def _toggle(self) -> None:
        if self.player.playing:
            self.player.pause()
        else:
            self.player.play()
        self.play.label = "Pause" if self.player.playing else "Play"

    def _slid(self, event: viser.GuiEvent[viser.GuiSliderHandle[float]]) -> None:
        if event.client is not None:  # a hand, not the player
            self.player.pause()
            self.seek(event.target.value)

    def _drop_marker(self) -> None:
        if self._marker is not None:
            self._marker.remove()
            self._marker = None


def facts(log: Log, elapsed: float, joint_names: list[str]) -> str:
    """The row, the joint that tracks worst, and the highest speed and torque, as Markdown."""
    row = log.row(elapsed)
    note = log.row_notes[row] if log.row_notes else f"row {row + 2} of {len(log.time) + 1}"
    lines = [f"**{log.name}**, {note}"]
    if "q" in log.signals and "q_des" in log.signals:
        error = log.signals["q_des"][row] - log.signals["q"][row]
        i = int(np.argmax(np.abs(error)))
        lines.append(f"largest tracking error {1e3 * error[i]:.2f} mrad or mm: {joint_names[i]}")
    for signal, what in (("dq", "rad/s or m/s"), ("tau", "N m or N")):
        if signal in log.signals:
            values = log.signals[signal][row]
            i = int(np.argmax(np.abs(values)))
            lines.append(f"{signal} at most {values[i]:.3g} {what}: {joint_names[i]}")
    lines += [log.expected] if log.expected else []
    return "\n\n".join(lines)
