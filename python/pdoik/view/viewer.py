"""What the page is: a session, its scene and its panel, and what happens when they are touched."""

from __future__ import annotations

import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import viser

import pdoik
from pdoik._hulls import wide_hulls
from pdoik.clouds import load_cloud
from pdoik.errors import PdoikError
from pdoik.scenes import read_scene_file

from .camera import FittedCamera, View
from .drawing.balance_scene import BalanceScene
from .drawing.gizmos import Gizmo
from .drawing.limit_scene import LimitScene
from .drawing.nearest_scene import NearestScene
from .drawing.obstacle_scene import ObstacleScene
from .drawing.path_scene import PathScene
from .drawing.scene import RobotScene, camera_of, robot_size
from .drawing.shape_scene import ShapeScene
from .drawing.target_gizmos import TargetGizmos
from .examples import Example
from .goals import GoalKind
from .humanoid import floor_height
from .log import load_log
from .model import Model, builtin_model, deepest_tip, read_robot, urdf_model
from .narrow import stack_when_narrow
from .pages import PagesLine
from .panels.examples_menu import ExamplesMenu
from .panels.files_tab import FilesTab
from .panels.joints_tab import JointsTab
from .panels.reach_tab import ReachTab
from .panels.replay_tab import ReplayTab
from .panels.solve_tab import SolveTab
from .reach import load_map
from .session import Session
from .status import Status
from .worker import Worker

FloatArray = npt.NDArray[np.float64]

_FOV = 0.7  # height of what the camera sees [rad]


class Viewer:
    """Draws a session on a server's page and takes what is dragged, typed and uploaded there.

    Attributes:
        server: Of the page.
        model: The robot that is drawn.
        session: What is solved; another one for each robot.
        read_path: Gives the stations in a file, as `pdoik.Solver.solve_path` takes them.
        worker: The thread that solves and draws.
        targets: The gizmos of the tips.

    Raises:
        ValueError: The solver refuses the robot, or the model does not fit the session.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        model: Model,
        session: Session,
        example: Example | None = None,
        read_path: Callable[[Path], Any] | None = None,
    ) -> None:
        self.server = server
        self.read_path = read_path
        self.session = session
        self.model = model
        self._folder = tempfile.TemporaryDirectory(
            prefix="pdoik-view-",
            ignore_cleanup_errors=True,  # one may be arriving
        )
        size = robot_size(model)
        self._floor = server.scene.add_grid(
            "/floor",
            infinite_grid=True,
            cell_size=0.1,
            section_size=1.0,
            cell_color=(226, 229, 234),
            section_color=(196, 202, 211),
            fade_distance=8 * size,
        )
        self.camera = FittedCamera(server, *_view(model, session, example), _FOV)
        self.balance_scene = BalanceScene(server)
        self.obstacle_scene = ObstacleScene(server, 0.13 * size, self._drag_ball, self._drag_cloud)
        self.shape_scene = ShapeScene(server)
        self.nearest_scene = NearestScene(server)
        self.limit_scene = LimitScene(server)
        self.path_scene = PathScene(server)
        self._path: tuple[str, Any, dict[str, Any]] | None = None  # that is followed
        self._drawing = threading.Lock()  # the robot is replaced by a hand, or posed by the worker
        self._gripping = threading.Lock()  # choices come from threads of their own
        self._gripped: tuple[str, Gizmo] | None = None  # a shape and what it is dragged by
        self._grips = 0
        self.obstacle_scene.ball.place(_at(np.array([0.25, -0.4, 0.3]) * size))
        self._add_robot()

        gui = server.gui
        gui.set_panel_label("pdoik view")
        stack_when_narrow(gui)
        self.examples = ExamplesMenu(gui, self, example)
        self.status = Status(gui)
        self.pages = PagesLine(server)
        tabs = gui.add_tab_group()
        self._solve_container = tabs.add_tab("Solve")
        with self._solve_container:
            self.solve_tab = SolveTab(gui, self)
        self._joints_container = tabs.add_tab("Joints")
        with tabs.add_tab("Replay"):
            self.replay_tab = ReplayTab(gui, self)
        with tabs.add_tab("Reach"):
            self.reach_tab = ReachTab(gui, self)
        with tabs.add_tab("Files"):
            self.files_tab = FilesTab(gui, self)
        self.joints_tab: JointsTab | None = None
        self._follow_robot()
        self.grip(None if example is None else example.grip)
        self.worker = Worker(self._step, lambda error: self.status.say(_words(error), bad=True))
        self.worker.wake()

    def close(self) -> None:
        """End the threads; the server is the caller's."""
        self.replay_tab.player.stop()
        self.reach_tab.close()
        self.worker.stop()
        self.forget_uploads()

    def forget_uploads(self) -> None:
        """Remove the files that came through the page; waits for nothing."""
        self._folder.cleanup()

    # What the worker does.

    def _step(self) -> None:
        shown = self.session.solve_once()
        if shown is None:
            return
        with self._drawing, self.server.atomic():
            if shown.robot is not self.model.robot:
                return
            self.robot_scene.show(shown)
            self.obstacle_scene.show(shown)
            self.shape_scene.show(shown)
            self.targets.show(shown)
            self.balance_scene.show(shown)
            self.nearest_scene.show(shown)
            self.limit_scene.show(shown)
            self.solve_tab.show(shown)
            if self.joints_tab is not None:
                if shown.origin != "joints":
                    self.joints_tab.show(shown.q)
                self.joints_tab.show_limit(shown.q)
            self.status.show(shown)

    # What is dragged. These run on the page's event loop and only note the wish.

    def _drag_target(self, session: Session, tip: str, T_base_tip: FloatArray, which: int) -> None:
        session.set_target(tip, T_base_tip, which)
        self.worker.wake()

    def _drag_ball(self, T: FloatArray) -> None:
        ball = self.session.obstacles.ball
        if ball is not None:
            self.session.set_ball(T[:3, 3], ball.radius)
            self.worker.wake()

    def _drag_cloud(self, T_base_cloud: FloatArray) -> None:
        self.session.set_cloud_pose(T_base_cloud)
        self.worker.wake()

    def grip(self, name: str | None) -> None:
        """Give the shape of that name a gizmo, and no other one."""
        with self._gripping:
            self._let_go()
            for shape in self.session.obstacles.shapes:
                if shape.name == name:
                    gizmo = Gizmo(
                        self.server,
                        f"/gripped/{self._grips}",
                        np.asarray(shape.T_base_shape),
                        0.6 * self._gizmo_size(),
                        lambda T: self._drag_shape(shape.name, T),  # noqa: B023  # the last one
                        turns=shape.kind != "sphere",
                    )
                    self._grips += 1
                    self._gripped = shape.name, gizmo
                    break
        self.solve_tab.follow_shapes(self.session, name)

    def _let_go(self) -> None:
        if self._gripped is not None:
            self._gripped[1].remove()
            self._gripped = None

    def _drag_shape(self, name: str, T_base_shape: FloatArray) -> None:
        self.session.move_shape(name, T_base_shape)
        self.worker.wake()

    def _slide(self, session: Session, index: int, position: float) -> None:
        session.set_joint(index, position)
        self.worker.wake()

    # What the Solve tab changes.

    def change_options(self, **changes: Any) -> None:
        with self.complaints():
            self.session.set_options(**changes)
            self.worker.wake()

    def change_goal(self, tip: str, kind: GoalKind) -> None:
        with self.complaints():
            self.session.set_goal(tip, kind)
            self._follow_goals()
            self.targets.place(self.session.tip_goals, tip)
            self.worker.wake()

    def change_cone(self, tip: str, cone: float) -> None:
        with self.complaints():
            self.session.set_cone(tip, cone)
            self.worker.wake()

    def type_target(self, tip: str, T_base_tip: FloatArray, which: int = 0) -> None:
        with self.complaints():
            self.session.set_target(tip, T_base_tip, which)
            self.targets.all_of(tip)[which].place(T_base_tip)
            self.worker.wake()

    def add_target(self, tip: str) -> None:
        with self.complaints():
            T = self.session.tip_goals[tip].targets[-1].copy()
            T[1, 3] += 1.2 * self._gizmo_size()
            self.session.add_target(tip, T)
            self._follow_goals()
            self.worker.wake()

    def drop_target(self, tip: str) -> None:
        with self.complaints():
            self.session.drop_target(tip)
            self._follow_goals()
            self.worker.wake()

    def show_solution(self, q: FloatArray) -> None:
        with self.complaints():
            self.session.show_solution(q)
            self.worker.wake()

    def _follow_goals(self) -> None:
        """Fit gizmos and numbers to what is asked of the tips."""
        with self._drawing, self.server.atomic():
            self.targets.follow(self.session.tip_goals)
            self.solve_tab.follow_goals()

    def show_ball(self, on: bool, radius: float) -> None:
        """Put the ball where its gizmo is, or take it away [m]."""
        self.session.set_ball(self.obstacle_scene.ball.pose[:3, 3] if on else None, radius)
        self.worker.wake()

    def move_cloud(self, on: bool) -> None:
        """Give the cloud its gizmo, or take that away."""
        self.obstacle_scene.place_handle(self.session.obstacles.T_base_cloud)
        self.obstacle_scene.cloud.show(on and len(self.session.obstacles.surface) > 0)

    # What comes from files.

    def take_example(self, example: Example) -> None:
        with self.complaints():
            model, session = example.make()
            self._replace_robot(model, session, example)
            if example.maps:
                self.reach_tab.start_coarse()

    def take_builtin(self, name: str) -> None:
        if name in pdoik.Robot.builtin_names() and (
            self.model.urdf is not None or name != self.model.robot.name
        ):
            with self.complaints():
                self._replace_robot(builtin_model(name))

    def take_urdf(self, file: viser.UploadedFile) -> None:
        with self.complaints():
            path = self._keep(file)
            robot = read_robot(path)
            model = urdf_model(robot, path, self.model.packages)
            try:
                self._replace_robot(model)
            except ValueError:  # several tips, which the solver may refuse
                self._replace_robot(model.with_tip(deepest_tip(robot)))

    def take_tip(self, tip_link: str | None) -> None:
        if self.model.urdf is not None:
            with self.complaints():
                self._replace_robot(self.model.with_tip(tip_link))

    def take_hulls(self, file: viser.UploadedFile) -> None:
        with self.complaints():
            self._replace_robot(self.model.with_hulls(pdoik.Occupancy.load(self._keep(file))))

    def fit_hulls(self) -> None:
        """Fit hulls around the collision geometry; takes seconds to minutes."""
        from pdoik.occupancy_fit import fit_occupancy

        model = self.model
        if model.urdf is None:
            return
        with self.complaints():
            self.status.say("fitting a collision model ...")
            fit = fit_occupancy(model.urdf, model.packages, capsules=False)
            known = set(model.robot.link_names)
            text = fit.to_yaml()
            if model is self.model:
                self._replace_robot(model.with_hulls(_of_links(pdoik.Occupancy.load(text), known)))

    def take_cloud(self, file: viser.UploadedFile) -> None:
        with self.complaints():
            self.status.say(f"{file.name}: reading ...")
            points = load_cloud(self._keep(file))
            self._take_points(file.name, points)

    def _take_points(self, name: str, points: FloatArray) -> None:
        self.status.say(f"{name}: thinning {len(points):,} points ...")
        session = self.session
        kept = session.set_cloud_once_thinned(points)
        if session is not self.session:  # another robot was chosen meanwhile
            self.session.set_cloud(points)
        self.status.say(f"{name}: {len(points):,} points, {kept:,} of them kept")
        self.worker.wake()

    def drop_cloud(self) -> None:
        self.session.set_cloud(None)
        self.obstacle_scene.cloud.show(False)
        self.worker.wake()

    def take_scene(self, file: viser.UploadedFile) -> None:
        with self.complaints():
            scene = read_scene_file(
                self._keep(file), packages=self.model.packages, robot=self.model.robot
            )
            if scene.attached:
                names = ", ".join(shape.name for each in scene.attached for shape in each.shapes)
                raise ValueError(f"links carry {names} in it, which this page does not know")
            self.session.set_shapes(scene.shapes, scene.contacts)
            self.grip(None)
            if len(scene.surface):
                self.session.set_cloud(scene.surface)
            self.status.say(f"{file.name}: {len(scene.shapes)} shapes, {len(scene.surface)} points")
            self.worker.wake()

    def drop_shapes(self) -> None:
        self.session.set_shapes(())
        self.grip(None)
        self.worker.wake()

    def take_log(self, file: viser.UploadedFile) -> None:
        with self.complaints():
            self.replay_tab.load(load_log(self._keep(file), self.session.robot.joint_names))

    def take_path(self, file: viser.UploadedFile) -> None:
        if self.read_path is None:
            return
        with self.complaints():
            self.follow_path(file.name, self.read_path(self._keep(file)))

    def follow_path(self, name: str, stations: Any, **asked: Any) -> None:
        """Find the motion along a path, as `Session.follow` does, and play it.

        Raises:
            ValueError: As `Session.follow`.
        """
        session = self.session
        self.status.say(f"{name}: looking for a motion ...")
        followed = session.follow(name, stations, **asked)
        with self._drawing, self.server.atomic():
            if session is not self.session:  # another robot was chosen meanwhile
                return
            self._path = name, stations, asked
            self.path_scene.show(followed)
        if followed.log is None:
            self.replay_tab.unload()
        else:
            self.replay_tab.load(followed.log)
        self.replay_tab.again.visible = True
        self.status.say(f"{name}: {followed.result.message}", bad=not followed.result.success)

    def follow_again(self) -> None:
        if self._path is not None:
            name, stations, asked = self._path
            with self.complaints():
                self.follow_path(name, stations, **asked)

    def take_map(self, file: viser.UploadedFile) -> None:
        with self.complaints():
            path = self._keep(file)
            self.reach_tab.map.show(load_map(path, self.session.robot), f"from {file.name}")

    def _keep(self, file: viser.UploadedFile) -> Path:
        path = Path(self._folder.name) / Path(file.name).name
        path.write_bytes(file.content)
        return path

    @contextmanager
    def complaints(self) -> Iterator[None]:
        """Say on the page what was wrong in the block, and leave things as they were."""
        try:
            yield
        except (PdoikError, ValueError, TypeError, OSError) as error:
            self.status.say(_words(error), bad=True)

    # Robots.

    def _replace_robot(
        self, model: Model, session: Session | None = None, example: Example | None = None
    ) -> None:
        if session is None:
            options = replace(self.session.options, balance=pdoik.Balance())  # over other links
            session = Session(model.robot, options, obstacles=self.session.obstacles)
        with self._drawing, self.server.atomic():
            if model.robot.name != self.model.robot.name or example is not None:
                self.camera.go_to(*_view(model, session, example))
            self.examples.follow(example)
            self.targets.remove()
            self.balance_scene.remove()
            self.limit_scene.remove()
            self.robot_scene.remove()
            self.replay_tab.unload()
            self.path_scene.remove()
            self._path = None
            self.model, self.session = model, session
            self._add_robot()
            self._follow_robot()
            self.grip(None if example is None else example.grip)
        self.worker.wake()

    def _add_robot(self) -> None:
        size = robot_size(self.model)
        self.robot_scene = RobotScene(self.server, self.model, size)
        self.limit_scene.follow_robot(self.model.robot, size)
        self.shape_scene.follow_robot(size)
        self.targets = TargetGizmos(
            self.server,
            self.session.tip_goals,
            self._gizmo_size(),
            partial(self._drag_target, self.session),  # of this robot, even if it is gone by then
        )
        self._floor.position = np.array([0.0, 0.0, floor_height(self.model.robot)])

    def _gizmo_size(self) -> float:
        return (0.2 if len(self.session.targets) == 1 else 0.16) * robot_size(self.model)

    def _follow_robot(self) -> None:
        """Fit the panel to the robot."""
        robot = self.model.robot
        if self.joints_tab is not None:
            self.joints_tab.remove()
        with self._joints_container:
            self.joints_tab = JointsTab(self.server.gui, robot, partial(self._slide, self.session))
        self.joints_tab.show(self.session.q)
        with self._solve_container:
            self.solve_tab.follow_robot()
        self.reach_tab.follow_robot()
        self.files_tab.show(robot, from_file=self.model.urdf is not None)
        self.solve_tab.apply_parts(self)
        facts = f"{robot.name}: {robot.dof} joints, {_collision_model(robot)}"
        if self.model.visuals:
            facts += f", meshes of {len(self.model.visuals)} links"
        if not len(robot.occupancy):
            facts += ": obstacles cannot be seen"
        if self.model.notes:
            facts += f"; {len(self.model.notes)} links lack meshes: {self.model.notes[0]}"
        self.status.say(facts)


def _view(model: Model, session: Session, example: Example | None) -> View:
    """What the camera looks at first, and from where."""
    if example is not None and example.view is not None:
        look_at, position = example.view
        return np.array(look_at), np.array(position)
    return camera_of(model, session.q)


def _of_links(occupancy: pdoik.Occupancy, known: set[str]) -> pdoik.Occupancy:
    """The hulls on these links only."""
    return pdoik.Occupancy(
        spheres=[hull for hull in occupancy.spheres if hull[0] in known],
        spheroids=[hull for hull in occupancy.spheroids if {hull[0], hull[2]} <= known],
        capsules=[hull for hull in occupancy.capsules if hull[0] in known],
    )


def _at(xyz: FloatArray) -> FloatArray:
    T = np.eye(4)
    T[:3, 3] = xyz
    return T


def _words(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


def _collision_model(robot: pdoik.Robot) -> str:
    """'collision model of 107 capsules'."""
    occupancy, bounding = robot.occupancy, wide_hulls(robot)
    spheres = len(occupancy.spheres)
    counts = {
        "spheres": spheres - sum(k < spheres for k in bounding),
        "spheroids": len(occupancy.spheroids) - sum(k >= spheres for k in bounding),
        "capsules": len(occupancy.capsules),
    }
    named = [f"{count} {kind}" for kind, count in counts.items() if count > 0]
    return f"collision model of {' and '.join(named)}" if named else "no collision model"
