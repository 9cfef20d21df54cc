"""The tab with what is asked of the solver and what is shown."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import viser

import pdoik
from pdoik._hulls import wide_hulls

from ..goals import GoalKind
from ..humanoid import balance_over_feet, can_balance
from .alternatives_panel import AlternativesPanel
from .goals_panel import GoalsPanel
from .solutions_panel import SolutionsPanel
from .targets_panel import TargetsPanel

if TYPE_CHECKING:
    from ..page import Page
    from ..session import Session
from ..shown import Shown

AXES = ("x", "y", "z")
METHODS = ("default", "paper")
NOTHING = "none"


class SolveTab:
    """Goals, method, what holds, obstacles, thinning, and checkboxes of what to draw."""

    def __init__(self, gui: viser.GuiApi, page: Page) -> None:
        options, obstacles = page.session.options, page.session.obstacles
        axis = options.goal_axis if isinstance(options.goal_axis, str) else "z"
        self._page = page
        self._gui = gui
        self.goals: GoalsPanel | None = None  # see `follow_robot`
        self.alternatives: AlternativesPanel | None = None
        self.solutions: SolutionsPanel | None = None
        self.targets: TargetsPanel | None = None
        self.position_first: Any = gui.add_checkbox(
            "Position first",
            options.priority == "position",
            hint="The position has to be met, and the orientation as near as it can be",
            order=-95.0,
        )
        self.goal_axis = gui.add_dropdown(
            "Axis",
            AXES,
            initial_value=axis,
            hint="Of the tip link: which has to point",
            order=-99.0,
        )
        self.method = gui.add_dropdown(
            "Method", METHODS, initial_value=options.method, hint="paper: PDO-IK as published"
        )
        self.clearance = gui.add_slider(
            "Clearance [mm]",
            0.0,
            100.0,
            1.0,
            min(1e3 * options.clearance, 100.0),
            hint="Least distance between robot and obstacles",
        )
        self.leaf = gui.add_slider(
            "Voxel size [mm]",
            0.0,
            150.0,
            5.0,
            min(1e3 * obstacles.leaf, 150.0),
            hint="Of the point cloud one point is kept in each voxel; 0 keeps all points",
        )
        self.radii = gui.add_checkbox(
            "Cover removed points",
            obstacles.radii,
            hint="Points that are kept get a radius that covers those that are not",
        )
        self.fixed = gui.add_checkbox(
            "Base collision",
            options.base_collision,
            hint="Fail where an obstacle touches a link that no joint moves",
        )
        self.self_collision: Any = gui.add_checkbox(
            "Self-collision", False, hint="Keep links off each other, too"
        )
        self.balance: Any = gui.add_checkbox(
            "Balance", False, hint="Keep the centre of mass over the feet"
        )
        with gui.add_folder("Obstacles"):
            self.ball = gui.add_checkbox(
                "Ball", obstacles.ball is not None, hint="An obstacle to drag"
            )
            self.radius = gui.add_slider("Ball radius [mm]", 10.0, 250.0, 5.0, 60.0)
            self.move_shape: Any = gui.add_dropdown(
                "Move obstacle", (NOTHING,), visible=False, hint="Which one has arrows"
            )
            self.move_cloud = gui.add_checkbox("Move point cloud", False)
        with gui.add_folder("Show"):
            self.hulls = gui.add_checkbox(
                "Collision model", True, hint="What is kept off obstacles"
            )
            self.wide_hulls = gui.add_checkbox(
                "Bounding spheroids", False, hint="Of links: where the capsules are looked at"
            )
            self.meshes = gui.add_checkbox("Meshes", True, hint="As the robot looks")
            self.skeleton: Any = gui.add_checkbox("Skeleton", False, hint="Inside the links")
            self.cloud = gui.add_checkbox("Point cloud", True)
            self.shapes = gui.add_checkbox("Shapes", True)
            self.nearest: Any = gui.add_checkbox(
                "Nearest obstacle", True, hint="A line to it from the robot"
            )
            self.limit: Any = gui.add_checkbox(
                "Nearest joint limit", True, hint="A ring around the joint"
            )

        def on_options(event: viser.GuiEvent[Any]) -> None:
            if event.client is None:  # not a hand, but `follow_robot`
                return
            page.change_options(
                goal_axis=self.goal_axis.value,
                priority="position" if self.position_first.value else "both",
                method=self.method.value,
                clearance=self.clearance.value / 1e3,
                base_collision=self.fixed.value,
                self_collision=self.self_collision.value,
                balance=balance_over_feet() if self.balance.value else pdoik.Balance(),
            )

        for control in (
            self.position_first,
            self.goal_axis,
            self.method,
            self.clearance,
            self.fixed,
            self.self_collision,
            self.balance,
        ):
            control.on_update(on_options)

        def on_thinning(_: object) -> None:
            page.session.set_thinning(self.leaf.value / 1e3, self.radii.value)
            page.worker.wake()

        for control in (self.leaf, self.radii):
            control.on_update(on_thinning)

        def on_ball(_: object) -> None:
            page.show_ball(self.ball.value, self.radius.value / 1e3)

        for control in (self.ball, self.radius):
            control.on_update(on_ball)

        def on_move_shape(event: viser.GuiEvent[Any]) -> None:
            if event.client is not None:  # a hand, not `follow_shapes`
                name = self.move_shape.value
                page.grip(None if name == NOTHING else name)

        self.move_shape.on_update(on_move_shape)
        self.move_cloud.on_update(lambda _: page.move_cloud(self.move_cloud.value))

        def on_parts(_: object) -> None:
            self.apply_parts(page)

        for control in (
            self.hulls,
            self.wide_hulls,
            self.meshes,
            self.skeleton,
            self.cloud,
            self.shapes,
            self.nearest,
            self.limit,
        ):
            control.on_update(on_parts)

    def follow_robot(self) -> None:
        """Fit what depends on the robot; call it inside the tab."""
        session = self._page.session
        robot = session.robot
        for panel in (self.goals, self.alternatives, self.solutions, self.targets):
            if panel is not None:
                panel.remove()
        self.goals = GoalsPanel(self._gui, session, self._goal_chosen, self._page.change_cone)
        self.alternatives = AlternativesPanel(self._gui, self._page)
        self.solutions = SolutionsPanel(self._gui, self._page)
        self.targets = TargetsPanel(self._gui, session, self._page.type_target)
        self._fit_to_goals(self.goals)
        self.self_collision.visible = len(robot.occupancy) > 0
        self.wide_hulls.visible = len(wide_hulls(robot)) > 0
        self.self_collision.value = session.options.keeps_off_itself(robot)
        self.skeleton.value = not self._page.model.visuals and not len(robot.occupancy)
        self.balance.visible = can_balance(robot)
        self.balance.value = bool(session.options.balance.contacts)

    def follow_shapes(self, session: Session, gripped: str | None) -> None:
        """Offer the shapes that there are now, and name the one that has arrows."""
        names = [each.name for each in session.obstacles.shapes if each.kind != "half_space"]
        self.move_shape.options = (NOTHING, *names)
        self.move_shape.value = gripped if gripped in names else NOTHING
        self.move_shape.visible = bool(names)

    def show(self, shown: Shown) -> None:
        """Follow the targets, and which are met."""
        for panel in (self.alternatives, self.solutions):
            if panel is not None:
                panel.show(shown)
        if self.targets is not None:
            self.targets.show(shown.goals)

    def follow_goals(self) -> None:
        """Fit what depends on what is asked of the tips."""
        if self.targets is not None:
            self.targets.follow(self._page.session.tip_goals)

    def _goal_chosen(self, tip: str, kind: GoalKind) -> None:
        assert self.goals is not None
        self._fit_to_goals(self.goals)
        self._page.change_goal(tip, kind)

    def _fit_to_goals(self, goals: GoalsPanel) -> None:
        self.goal_axis.visible = goals.has_axis
        self.position_first.visible = goals.turns

    def apply_parts(self, page: Page) -> None:
        """Show what is ticked."""
        page.robot_scene.show_parts(
            hulls=self.hulls.value,
            wide_hulls=self.wide_hulls.value,
            meshes=self.meshes.value,
            skeleton=self.skeleton.value,
        )
        page.obstacle_scene.show_cloud(self.cloud.value)
        page.shape_scene.show_shapes(self.shapes.value)
        page.nearest_scene.show_line(self.nearest.value)
        page.limit_scene.show_mark(self.limit.value)
