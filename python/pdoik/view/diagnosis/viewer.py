"""The page of a diagnosis: three robots, a time to be played, findings, residuals."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import trimesh
import viser

from pdoik._addresses import Packages
from pdoik.errors import PdoikError
from pdoik.sim2real import load_study
from pdoik.sim2real.evidence import Motions, replay_of
from pdoik.sim2real.report import VERDICTS, number

from ..camera import FittedCamera
from ..drawing.shapes import pose_of
from ..message import Message
from ..narrow import stack_when_narrow
from ..pages import PagesLine
from ..player import Player
from .colors import RECORDED, color_of, legend_html
from .drawn_robot import DrawnRobot, drawn_robot
from .findings_tab import FindingsTab
from .numbers_tab import NumbersTab
from .report import Report
from .residual_plot import ResidualPlot
from .robot_copy import RobotCopy
from .timeline import COPIES, Timeline

FloatArray = npt.NDArray[np.float64]

SPEEDS = ("0.1", "0.25", "0.5", "1", "2", "5")
TIMES = ("1", "3", "10", "30", "100")
SIDE_BY_SIDE, ONE_PLACE = "side by side", "in one place"
_TITLES = {
    "recorded": "recorded",
    "before": "simulated before",
    "after": "simulated after",
}
_STEP = 0.8  # from robot to robot, of what one passes through
_APART = 1.1  # the same, of what one extends over
_FOV = 0.2  # [rad], so small that equal postures look equal
_LOOKS = 40  # at a recording, to see where the robot is
_LONG = 1.3  # extent ahead, over that across, from which the view turns
_SLOW = 0.2  # between two updates of words and plots [s]


class DiagnosisViewer:
    """Draws a report on a server's page.

    Attributes:
        server: Of the page.
        report: What is shown.
        timeline: Of the recording that is chosen.
        copies: The robots, by "recorded", "before", "after"; none where the study has no robot.
        player: Of the time.
    """

    def __init__(self, server: viser.ViserServer, report: Report, packages: Packages = ()) -> None:
        self.server, self.report = server, report
        self._lock = threading.RLock()
        self._simulating = False
        motions = report.motions
        self._timelines = [Timeline(motion) for motion in motions.motions]
        chosen = next((t for t in self._timelines if t.simulated), self._timelines[-1])
        self.timeline = chosen
        self.joint = motions.joints[_worst(chosen)]
        self.copies: dict[str, RobotCopy] = {}
        self._drawn: DrawnRobot | None = None
        self._reach, self._step, self._across = np.zeros((2, 3)), 0.0, np.eye(3)[1]
        notes = self._add_robots(packages)
        gui = server.gui
        gui.set_panel_label("pdoik view: diagnosis")
        stack_when_narrow(gui)
        self.headline = gui.add_html(_headline(report))
        self.recording: Any = gui.add_dropdown(
            "Recording", tuple(_said(t) for t in self._timelines), initial_value=_said(chosen)
        )
        self.play = gui.add_button("Play", icon=viser.Icon.PLAYER_PLAY)
        self.time: Any = gui.add_slider("Time [s]", 0.0, max(chosen.duration, 0.01), 0.01, 0.0)
        self.legend = gui.add_html("")
        self.shown_joint: Any = gui.add_dropdown(
            "Joint", motions.joints, initial_value=self.joint, hint="Which residual is plotted"
        )
        self.plot = ResidualPlot(gui)
        self.message = Message(gui)
        self.notes = Message(gui)
        self.pages = PagesLine(server)
        tabs = gui.add_tab_group()
        with tabs.add_tab("Findings"):
            self.findings = FindingsTab(gui, report.diagnosis, self.point_at, self.ring_link)
        with tabs.add_tab("Numbers"):
            self.numbers = NumbersTab(gui, motions)
        with tabs.add_tab("Show"):
            self.speed = gui.add_dropdown("Speed", SPEEDS, initial_value="1")
            self.layout = gui.add_dropdown("Robots", (SIDE_BY_SIDE, ONE_PLACE))
            self.times = gui.add_dropdown(
                "Differences x", TIMES, hint="How much larger they are drawn than they are"
            )
            self.parts = {
                name: gui.add_checkbox(_TITLES[name].capitalize(), True) for name in COPIES
            }
            self.simulate = gui.add_button(
                "Simulate this recording", hint="Before and with the findings; takes a while"
            )
        self.player = Player(self._tick)
        self.play.on_click(lambda _: self._toggle())
        self.time.on_update(self._slid)
        self.recording.on_update(lambda _: self._choose())
        self.shown_joint.on_update(lambda _: self.point_at(self.shown_joint.value))
        self.speed.on_update(lambda _: self.player.set_speed(float(self.speed.value)))
        self.layout.on_update(lambda _: self._arrange())
        self.times.on_update(lambda _: self.show(self.player.elapsed))
        for box in self.parts.values():
            box.on_update(lambda _: self._arrange())
        self.simulate.on_click(lambda _: self._simulate())
        self._slow_at = -1.0
        self._choose()
        if notes:
            self.notes.say("; ".join(notes))

    def close(self) -> None:
        """End the threads; the server is the caller's."""
        self.player.stop()

    # What is shown.

    def show(self, elapsed: float, *, slow: bool = True) -> None:
        """Stand at a time of the recording [s]; `slow` things are words and the plot's mark."""
        with self._lock, self.server.atomic():
            line = self.timeline
            times = float(self.times.value)
            base = line.base(elapsed)
            for name, copy in self.copies.items():
                copy.pose(line.q(name, elapsed, times), base)
                if name != "recorded":
                    copy.paint(self._colors(line.residual(name, elapsed)), RECORDED)
                copy.name(self._title(name, elapsed))
            if slow:
                self.plot.mark(elapsed)
                self.numbers.show(line, elapsed)

    def point_at(self, joint: str) -> None:
        """Ring a joint and plot its residual."""
        with self._lock, self.server.atomic():
            self.joint = joint
            if self.shown_joint.value != joint:
                self.shown_joint.value = joint
            j = self.report.motions.joints.index(joint)
            self.plot.show(self.timeline, j, self.report.motions)
            self.plot.mark(self.player.elapsed)
            for name, copy in self.copies.items():
                copy.ring(joint, self.timeline.q(name, self.player.elapsed))

    def ring_link(self, link: str) -> None:
        """Ring a link's origin."""
        with self._lock, self.server.atomic():
            for name, copy in self.copies.items():
                copy.ring_link(link, self.timeline.q(name, self.player.elapsed))

    def _colors(self, residual: FloatArray) -> dict[int, tuple[int, int, int]]:
        units = self.report.motions.units
        return {j: color_of(float(x), self._most[units[j]]) for j, x in enumerate(residual)}

    def _title(self, name: str, elapsed: float) -> str:
        title = _TITLES[name]
        if name != "recorded" and not self.timeline.is_simulated(elapsed):
            return f"{title.replace('simulated', 'recorded, residual')}"
        times = self.times.value
        return title if name == "recorded" or times == "1" else f"{title}, differences x {times}"

    # What is chosen.

    def _choose(self) -> None:
        """Another recording."""
        said = [_said(t) for t in self._timelines]
        with self._lock:
            self.timeline = line = self._timelines[said.index(self.recording.value)]
            self.player.load(line.duration)
            self.play.label = "Play"
            self.time.max = max(line.duration, 0.01)
            self.time.value = 0.0
            units = self.report.motions.units
            self._most = {
                unit: line.most([j for j, each in enumerate(units) if each == unit])
                for unit in dict.fromkeys(units)
            }
            what = f"residual of the {self.report.motions.residual_of}, rms over 0.5 s"
            self.legend.content = "".join(
                legend_html(most, unit, what) for unit, most in self._most.items()
            )
            model = self.report.model
            self.simulate.visible = bool(self.copies) and not line.simulated and not model.base
            self._arrange()
            self.point_at(self.joint)
            self.numbers.follow(line)
            how = _how(line, self.report.motions, floats=bool(model.base))
            self.message.say(how if self.copies else "The study has no robot.")

    def _arrange(self) -> None:
        """Place the robots and show those that are ticked."""
        if self._drawn is None:
            return
        top = float(self._reach[1, 2])
        step = self._step if self.layout.value == SIDE_BY_SIDE else 0.0
        rise = 0.08 * self._drawn.size
        for k, (name, copy) in enumerate(self.copies.items()):
            height = top + (1 + k % 2 if step else 1 + k) * rise  # so that names do not meet
            copy.place((k - 1) * step * self._across, height)
            copy.show(self.parts[name].value)
        self.show(self.player.elapsed)

    def _add_robots(self, packages: Packages) -> tuple[str, ...]:
        """The copies, the floor and the camera; gives notes."""
        if self.report.model.robot is None:
            return ()
        try:
            self._drawn = drawn = drawn_robot(self.report.model, packages)
        except (PdoikError, ValueError, OSError) as error:
            return (f"nothing is drawn: {error}",)
        self.copies = {name: RobotCopy(self.server, name, drawn) for name in COPIES}
        self.copies["recorded"].paint({}, RECORDED)
        boxes = _boxes(drawn, self.timeline)
        low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
        self._reach = np.array([low, high])
        x, y, height = (high - low).tolist()
        ahead, self._across = np.eye(3)[0], np.eye(3)[1]
        if x > _LONG * y:  # it is seen from where it moves across
            ahead, self._across = -np.eye(3)[1], np.eye(3)[0]
        across, depth = (x, y) if x > _LONG * y else (y, x)
        widest = float(np.ptp(boxes @ self._across, axis=1).max())
        self._step = max(_STEP * across, _APART * widest)
        self.server.scene.configure_fog(0.0, 1.0, enabled=False)
        self.server.scene.add_grid(
            "/floor",
            infinite_grid=True,
            cell_size=0.1,
            section_size=1.0,
            cell_color=(226, 229, 234),
            section_color=(196, 202, 211),
            fade_distance=40 * drawn.size,
            position=np.array([0.0, 0.0, min(float(low[2]), 0.0)]),
        )
        middle = (low + high) / 2
        wide = 2 * self._step + across
        away = max(wide / 1.1, 1.45 * height) / (2 * np.tan(_FOV / 2)) + depth / 2
        look_at = middle + 0.15 * wide * self._across
        position = look_at + away * (0.95 * ahead + np.array([0.0, 0.0, 0.3]))
        FittedCamera(self.server, look_at, position, _FOV)
        return drawn.notes

    # The time.

    def _tick(self, elapsed: float) -> None:
        """Show a time [s]; called by the player's thread."""
        slow = abs(elapsed - self._slow_at) > _SLOW or not self.player.playing
        if slow:
            self._slow_at = elapsed
            self.time.value = round(elapsed, 2)
        if not self.player.playing:
            self.play.label = "Play"
        self.show(elapsed, slow=slow)

    def _toggle(self) -> None:
        if self.player.playing:
            self.player.pause()
        else:
            self.player.play()
        self.play.label = "Pause" if self.player.playing else "Play"

    def _slid(self, event: viser.GuiEvent[Any]) -> None:
        if event.client is not None:  # a hand, not the player
            self.player.pause()
            self.play.label = "Play"
            self.player.seek(self.time.value)
            self.show(self.player.elapsed)

    # Simulations that the report does not hold.

    def _simulate(self) -> None:
        with self._lock:
            if self._simulating:
                return
            self._simulating = True
        line = self.timeline
        self.simulate.disabled = True
        self.message.say(f"{line.motion.name}: simulating ...")
        try:
            with self.complaints():
                simulated = self._simulated(line)
                self._timelines[self._timelines.index(line)] = simulated
                if self.timeline is line:
                    self._choose()
        finally:
            self._simulating = False
            self.simulate.disabled = False

    def _simulated(self, line: Timeline) -> Timeline:
        model = self.report.model
        if model.study is None or not Path(model.study).is_file():
            raise ValueError(f"the study is not where it was: {model.study}")
        study = load_study(model.study)
        recording = next((r for r in study.recordings if r.name == line.motion.name), None)
        if recording is None:
            raise ValueError(f"{model.study} has no recording {line.motion.name!r} any more")
        made = replay_of(model, study.setup_of(recording), recording, [])
        return Timeline(replace(line.motion, replay=made))

    @contextmanager
    def complaints(self) -> Iterator[None]:
        """Say on the page what was wrong in the block, and leave things as they were."""
        try:
            yield
        except (PdoikError, ValueError, TypeError, OSError) as error:
            self.message.say(" ".join(str(error).split()), bad=True)


def _said(line: Timeline) -> str:
    held_out = "held out" if line.motion.role == "validate" else "fitted to"
    return f"{line.motion.name} ({held_out})"


def _worst(line: Timeline) -> int:
    """The joint with the largest residual before."""
    squares = np.nan_to_num(line.motion.before) ** 2
    return int(np.argmax(squares.mean(axis=0)))


def _how(line: Timeline, motions: Motions, *, floats: bool) -> str:
    """How far the simulation goes off at the worst joint, and how it was made."""
    if floats:
        return "Not simulated, for its base floats: all three move as recorded."
    if line.motion.replay is None:
        return "Not simulated: all three move as recorded. Show, Simulate this recording."
    off = line.departures
    worst = int(np.argmax(np.nan_to_num(off["before"])))
    before, after = (number(1e3 * float(off[which][worst])) for which in ("before", "after"))
    small = "mm" if motions.position_units[worst] == "m" else "mrad"
    how = line.motion.replay.how
    simulation = "The simulation"
    if line.horizon is not None:
        simulation = f"Within {line.horizon:.2g} s the simulation"
    return (
        f"{simulation} goes off by {before} {small} before the findings and by {after} after, at"
        f" {motions.joints[worst]}. {how[:1].upper()}{how[1:]}."
    )


def _headline(report: Report) -> str:
    return (
        '<div style="padding:0.3em 1em;font-size:0.9em"><b>'
        f"{escape(VERDICTS[report.diagnosis.verdict][0])}</b><br>"
        "Play, or drag the time. Colours: the torque residual of the joint that moves a link.</div>"
    )


def _boxes(drawn: DrawnRobot, line: Timeline) -> FloatArray:
    """Lowest and highest corner of the robot, at times along a recording, (N, 2, 3) [m]."""
    return np.array([_box(drawn, line, t) for t in np.linspace(0.0, line.duration, _LOOKS)])


def _box(drawn: DrawnRobot, line: Timeline, t: float) -> FloatArray:
    """Lowest and highest corner of the robot at a time, (2, 3) [m]."""
    base = np.eye(4)
    pose = line.base(t)
    if pose is not None:
        base = pose_of(pose[3:], pose[:3])
    corners = np.concatenate(
        [
            trimesh.transform_points(
                trimesh.bounds.corners(drawn.meshes[link].bounds),  # type: ignore[no-untyped-call]
                base @ T,
            )
            for link, T in drawn.poses(line.q("recorded", t)).items()
        ]
    )
    return np.array([corners.min(axis=0), corners.max(axis=0)])
