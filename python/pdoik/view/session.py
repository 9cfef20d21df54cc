"""The live solving session: wishes come in from anywhere, one thread grants the latest."""

from __future__ import annotations

import dataclasses
import threading
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

import pdoik
from pdoik.solids import Binding, binding, clearances_of, nearest_obstacle

from .drawing.shapes import moved_shape
from .followed_path import FollowedPath, follow_path
from .follower import Follower
from .goals import (
    GOALS,
    MOST_REQUESTS,
    GoalKind,
    TipGoal,
    choice_of,
    choice_text,
    count_requests,
    default_goals,
    home,
    request_of,
    requests,
)
from .humanoid import first_posture
from .obstacles import Ball, Obstacles
from .shown import AllSolutions, Origin, Shown

FloatArray = npt.NDArray[np.float64]


class Session:
    """A robot, where its tips are wanted, and what is in the way.

    Setters only note a wish and return at once, whatever thread they are called from; `solve_once`
    grants the latest one and forgets those it replaced. One thread at a time may call `solve_once`.

    Args:
        robot: Has a target for each of its tip links.
        options: Of the solver.
        q0: First posture, (n,); None for the middle of the ranges, or the H1's stance.
        obstacles: What is in the way; None for nothing.
        goals: What is asked of each tip; None for the options' goal where the tip has the joints
            for it, otherwise its position.

    Raises:
        ValueError: An option is out of range, or the solver refuses the robot.
    """

    def __init__(
        self,
        robot: pdoik.Robot,
        options: pdoik.Options | None = None,
        q0: FloatArray | None = None,
        obstacles: Obstacles | None = None,
        goals: Mapping[str, GoalKind] | None = None,
    ) -> None:
        self.robot = robot
        self._lock = threading.Lock()
        self._options = options if options is not None else pdoik.Options()
        self._solver = Follower(robot, self._options)
        self._dragged: str | None = None
        self._q = first_posture(robot) if q0 is None else _configuration(q0, robot)
        self._origin: Origin = "joints"  # of the latest wish; if not "target", _q is the wish
        kinds = default_goals(robot, self._options.goal) if goals is None else dict(goals)
        self._goals = {
            tip: TipGoal(kind=kinds[tip], targets=(self._home(kinds[tip], tip),))
            for tip in robot.tip_links
        }
        self._met = dict.fromkeys(self._goals, 0)  # which target of each tip is followed
        self._obstacles = obstacles if obstacles is not None else Obstacles()
        self._thinned: list[tuple[Obstacles, FloatArray]] = []  # the last two
        self._wish = 1  # counts wishes
        self._granted = 0

    @property
    def q(self) -> FloatArray:
        """The posture that is shown, or about to be, (n,)."""
        with self._lock:
            return self._q.copy()

    @property
    def options(self) -> pdoik.Options:
        with self._lock:
            return self._options

    @property
    def obstacles(self) -> Obstacles:
        with self._lock:
            return self._obstacles

    @property
    def targets(self) -> dict[str, FloatArray]:
        """The first T_base_tip of each tip link, as wished for last."""
        with self._lock:
            return {tip: goal.targets[0].copy() for tip, goal in self._goals.items()}

    @property
    def goals(self) -> dict[str, GoalKind]:
        """The kind of what is asked of each tip link."""
        with self._lock:
            return {tip: goal.kind for tip, goal in self._goals.items()}

    @property
    def tip_goals(self) -> dict[str, TipGoal]:
        """All that is asked of each tip link."""
        with self._lock:
            return dict(self._goals)

    def set_goal(self, tip: str, kind: GoalKind) -> None:
        """Ask for a tip's pose, axis or position where it is now, or let it go free.

        A tip that was free, or looked at a point, has one target then: where it is now; and one
        that is to look at a point has that point straight ahead.

        Raises:
            ValueError: The robot has no such tip, or there is no such kind.
        """
        if kind not in GOALS:
            raise ValueError(f"goal of {tip}: expected one of {', '.join(GOALS)}; got {kind!r}")
        with self._lock:
            self._check_tip(tip)
            before = self._goals[tip]
            targets = before.targets
            if kind != before.kind and {kind, before.kind} & {"free", "look_at"}:
                targets = (self._home(kind, tip),)
            self._wish_goal(tip, replace(before, kind=kind, targets=targets))

    def set_cone(self, tip: str, cone: float) -> None:
        """How far the axis of a tip may point off its target's [rad].

        Raises:
            ValueError: The robot has no such tip.
        """
        with self._lock:
            self._check_tip(tip)
            self._wish_goal(tip, replace(self._goals[tip], cone=cone))

    def set_target(self, tip: str, T_base_tip: npt.ArrayLike, which: int = 0) -> None:
        """Wish for a tip's pose; its other targets stay, and the other tips keep theirs.

        Raises:
            ValueError: The robot has no such tip, or the tip has not so many targets, or the pose
                is not a finite 4x4 matrix.
        """
        T = _pose(T_base_tip, tip)
        with self._lock:
            self._check_tip(tip)
            targets = list(self._goals[tip].targets)
            if which >= len(targets):
                raise ValueError(f"{tip} has {len(targets)} targets, there is no {which + 1}")
            targets[which] = T
            self._dragged = tip
            self._wish_goal(tip, replace(self._goals[tip], targets=tuple(targets)))

    def add_target(self, tip: str, T_base_tip: npt.ArrayLike) -> None:
        """Another target of a tip, instead of which the others will do as well.

        Raises:
            ValueError: As `set_target`, or there would be too many ways to choose.
        """
        T = _pose(T_base_tip, tip)
        with self._lock:
            self._check_tip(tip)
            goal = replace(self._goals[tip], targets=(*self._goals[tip].targets, T))
            if count_requests(self._goals | {tip: goal}) > MOST_REQUESTS:
                raise ValueError(f"more than {MOST_REQUESTS} ways to choose targets")
            self._wish_goal(tip, goal)

    def drop_target(self, tip: str) -> None:
        """Remove the target of a tip that was added last; the first one stays.

        Raises:
            ValueError: The robot has no such tip.
        """
        with self._lock:
            self._check_tip(tip)
            goal = self._goals[tip]
            self._wish_goal(tip, replace(goal, targets=goal.targets[:-1] or goal.targets))

    def set_posture(self, q: npt.ArrayLike, origin: Literal["joints", "log"] = "joints") -> None:
        """Wish for a posture; the targets that are met, or were last, jump to the tips.

        Raises:
            ValueError: Not one finite number per joint.
        """
        posture = _configuration(q, self.robot)
        with self._lock:
            self._wish_posture(posture, origin)

    def set_joint(self, index: int, position: float) -> None:
        """Wish for one joint's position [rad] or [m]; the others stay where they are."""
        with self._lock:
            posture = self._q.copy()
            posture[index] = position
            self._wish_posture(posture, "joints")

    def show_solution(self, q: npt.ArrayLike) -> None:
        """Wish for a posture that meets the targets, which stay.

        Raises:
            ValueError: Not one finite number per joint.
        """
        posture = _configuration(q, self.robot)
        with self._lock:
            self._q, self._origin = posture, "solution"
            self._wish += 1

    def find_all(self, limit: int) -> AllSolutions:
        """All ways to meet the targets that are met now; may be called from any thread.

        Raises:
            ValueError: As `solve_once`, or limit is not positive.
        """
        with self._lock:
            goals, met, q = self._goals, self._met, self._q
            solver, obstacles = self._solver, self._obstacles
        scene = self._scene(obstacles)
        asked = requests(goals, None)[request_of(goals, met)]
        found = solver.solve_all(asked, limit, q, scene)
        return AllSolutions(robot=self.robot, found=found, choice=choice_text(goals, met))

    def follow(self, name: str, stations: Any, **asked: Any) -> FollowedPath:
        """Follow a whole path among the obstacles there are; may be called from any thread.

        Args:
            name: Of the path.
            stations: As `pdoik.Solver.solve_path` takes them.
            **asked: The same: closed, costs, ...

        Raises:
            ValueError: As `pdoik.Solver.solve_path`.
        """
        with self._lock:
            options, obstacles = self._options, self._obstacles
        scene = self._scene(obstacles)
        return follow_path(name, pdoik.Solver(self.robot, options), stations, scene, **asked)

    def set_options(self, **changes: Any) -> None:
        """Change fields of the options; `goal` is then asked of every tip.

        Raises:
            TypeError, ValueError: As `pdoik.Options` and `pdoik.Solver` raise them.
        """
        options = dataclasses.replace(self.options, **changes)
        solver = Follower(self.robot, options)
        with self._lock:
            if "goal" in changes:
                self._goals = {
                    tip: replace(goal, kind=options.goal) for tip, goal in self._goals.items()
                }
            self._options, self._solver, self._origin = options, solver, "target"
            self._wish += 1

    def set_cloud(self, points: npt.ArrayLike | None) -> None:
        """Take another cloud, (N, 3) in the base frame [m]; None for none.

        Raises:
            ValueError: The points have another shape.
        """
        surface = np.empty((0, 3)) if points is None else np.asarray(points, dtype=np.float64)
        if surface.ndim != 2 or surface.shape[1] != 3:
            raise ValueError(f"points have shape {surface.shape}, expected (N, 3)")
        self._change_obstacles(surface=surface, T_base_cloud=np.eye(4))

    def set_cloud_once_thinned(self, points: npt.ArrayLike) -> int:
        """`set_cloud` after thinning it, which takes seconds for millions of points.

        Until then the robot can be moved among the obstacles there are.

        Returns:
            How many points are kept.

        Raises:
            ValueError: As `set_cloud`, or the cloud cannot be thinned so finely.
        """
        surface = np.asarray(points, dtype=np.float64)
        kept = self._thin(replace(self.obstacles, surface=surface))
        self.set_cloud(surface)
        return len(kept)

    def set_shapes(
        self, shapes: Sequence[pdoik.Shape], contacts: Sequence[pdoik.ContactRule] = ()
    ) -> None:
        """Take other shapes, and rules of contact.

        Raises:
            ValueError: Two have one name, or a rule speaks of what is not there.
        """
        # Whoever looks at them says what is wrong with them.
        looks = pdoik.Solver(self.robot, pdoik.Options(ignore_obstacles_without_hulls=True))
        looks.clearances(self.robot.mid_configuration(), pdoik.Scene(shapes, contacts=contacts))
        self._change_obstacles(shapes=tuple(shapes), contacts=tuple(contacts))

    def move_shape(self, name: str, T_base_shape: npt.ArrayLike) -> None:
        """Move the shape of that name; others stay.

        Raises:
            ValueError: It is a half-space.
        """
        T = np.array(T_base_shape, dtype=np.float64)
        with self._lock:
            shapes = tuple(
                moved_shape(each, T) if each.name == name else each
                for each in self._obstacles.shapes
            )
        self._change_obstacles(shapes=shapes)

    def set_thinning(self, leaf: float, radii: bool) -> None:
        """How the cloud is thinned, see `Obstacles`."""
        self._change_obstacles(leaf=leaf, radii=radii)

    def set_cloud_pose(self, T_base_cloud: npt.ArrayLike) -> None:
        """Move the whole cloud."""
        self._change_obstacles(T_base_cloud=np.array(T_base_cloud, dtype=np.float64))

    def set_ball(self, center: npt.ArrayLike | None, radius: float = 0.05) -> None:
        """Put the ball there [m]; None takes it away."""
        ball = None
        if center is not None:
            x, y, z = (float(value) for value in np.asarray(center, dtype=np.float64))
            ball = Ball(center=(x, y, z), radius=radius)
        self._change_obstacles(ball=ball)

    def solve_once(self) -> Shown | None:
        """Grant the latest wish; None if it has been granted.

        A target is solved for from the posture shown last, so that the robot follows. A posture
        that was wished for meanwhile is not overruled by the answer.

        Raises:
            ValueError: The cloud cannot be thinned so finely, or the solver refuses the problem.
        """
        with self._lock:
            wish, goals, obstacles = self._wish, self._goals, self._obstacles
            origin, q, solver = self._origin, self._q, self._solver
            met, dragged = self._met, self._dragged
            if wish == self._granted:
                return None
            self._granted = wish  # even if it cannot be: it would fail again
        points = obstacles.placed(self._thin(obstacles))
        scene = obstacles.scene(points)
        asked = requests(goals, dragged)
        if origin == "target":
            result, found, number = solver.solve(asked, request_of(goals, met), q, scene)
            q, met = np.asarray(result.q), choice_of(goals, number)
            free = {tip: self._at_rest(q, tip) for tip in goals if goals[tip].kind == "free"}
            with self._lock:
                if self._origin == "target":
                    self._q, self._met = q, met
                    still = {tip for tip in free if self._goals[tip].kind == "free"}
                    self._goals = self._goals | {tip: free[tip] for tip in still}
            goals = goals | free
        else:
            result, number = solver.judge(asked, q, scene)
            found, met = result, choice_of(goals, number)
        names = [shape.name for shape in obstacles.shapes]
        failed = Binding() if result.success else binding(result, self.robot, names)
        return Shown(
            robot=self.robot,
            q=q,
            goals=goals,
            met=met,
            options=solver.options,
            result=result,
            found=found,
            obstacles=points,
            cloud=obstacles,
            nearest=nearest_obstacle(
                clearances_of(failed, solver.clearances(q, scene)),
                self.robot,
                q,
                points,
                obstacles.shapes,
                None if obstacles.ball is None else len(points) - 1,
            ),
            origin=origin,
        )

    def _check_tip(self, tip: str) -> None:
        if tip not in self._goals:
            raise ValueError(f"{tip!r} is no tip of {self.robot.name}: {list(self._goals)}")

    def _wish_goal(self, tip: str, goal: TipGoal) -> None:
        self._goals = self._goals | {tip: goal}
        self._met = self._met | {tip: min(self._met[tip], len(goal.targets) - 1)}
        self._origin = "target"
        self._wish += 1

    def _wish_posture(self, posture: FloatArray, origin: Origin) -> None:
        self._q = posture
        self._origin = origin
        for tip, goal in self._goals.items():
            targets = list(goal.targets)
            targets[self._met[tip]] = self._home(goal.kind, tip)
            self._goals = self._goals | {tip: replace(goal, targets=tuple(targets))}
        self._wish += 1

    def _change_obstacles(self, **changes: Any) -> None:
        with self._lock:
            self._obstacles = replace(self._obstacles, **changes)
            self._origin = "target"  # the arm gives way
            self._wish += 1

    def _home(self, kind: GoalKind, tip: str) -> FloatArray:
        return home(kind, self.robot, self._q, tip, self._options.goal_axis)

    def _at_rest(self, q: FloatArray, tip: str) -> TipGoal:
        return TipGoal(kind="free", targets=(self.robot.fk(q, tip),))

    def _scene(self, obstacles: Obstacles) -> pdoik.Scene | FloatArray:
        return obstacles.scene(obstacles.placed(self._thin(obstacles)))

    def _thin(self, obstacles: Obstacles) -> FloatArray:
        """The thinned cloud; thinning takes longer than solving, moving the cloud does not."""
        for known, thinned in self._thinned:
            same = known.surface is obstacles.surface
            if same and (known.leaf, known.radii) == (obstacles.leaf, obstacles.radii):
                return thinned
        thinned = obstacles.thinned()
        self._thinned = [*self._thinned[-1:], (obstacles, thinned)]
        return thinned


def _pose(T_base_tip: npt.ArrayLike, tip: str) -> FloatArray:
    T = np.array(T_base_tip, dtype=np.float64)
    if T.shape != (4, 4) or not np.isfinite(T).all():
        raise ValueError(f"target of {tip}: expected a finite (4, 4) matrix, got {T.tolist()}")
    return T


def _configuration(q: npt.ArrayLike, robot: pdoik.Robot) -> FloatArray:
    posture = np.array(q, dtype=np.float64)
    if posture.shape != (robot.dof,) or not np.isfinite(posture).all():
        raise ValueError(f"q: expected {robot.dof} finite numbers, got {posture.tolist()}")
    return posture
