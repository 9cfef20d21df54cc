"""A control loop's inverse kinematics."""

from typing import Any, Final

from numpy.typing import ArrayLike

from pdoik import _core
from pdoik._made import once_made
from pdoik._option_values import to_core
from pdoik.solver import Solver


class Tracker(_core.Tracker):
    """One step each period, from the last answer, by a deadline, never a jump.

    Every step begins with standing still. What comes nearest to the goals inside a box of speed
    limits times period, cut with the joint limits, takes its place only if it is no deeper in
    anything than standing still, nor than contact, all along the straight way there: in points,
    shapes, the robot itself, what is attached to it, beyond the balance it keeps. Half the room
    before contact is what one step may take, and what is touched is left first. A goal that cannot
    be reached is come near to, and the robot rests. There are no restarts. Bad numbers do not
    raise: the last answer stands, and the step says so. It belongs to one thread.

    >>> import numpy as np
    >>> import pdoik
    >>> robot = pdoik.Robot.builtin("panda")
    >>> tracker = pdoik.Tracker(pdoik.Solver(robot), period=0.001)
    >>> tracker.reset(robot.mid_configuration())
    >>> T_base_tip = robot.fk(robot.mid_configuration() + 1e-3)
    >>> tracker.step(T_base_tip).tracking
    'tracking'

    Args:
        solver: Its robot and options are taken; the budget of a solve does not count.
        period: Between steps [s].
        max_time: Hard deadline of a step [s]; None for 0.8 of the period.
        speed_share: Of the robot's speed limits, how much may be used.
        max_speed: Speed limits to hold besides those of the robot, shape (n,) [rad/s] or [m/s].
        max_acceleration: How much joint speeds may change in a second, shape (n,) [rad/s^2] or
            [m/s^2]; None for as much as they like. Joints then speed up and brake before goals,
            limits and obstacles, and goals that move are followed at their speed.
        posture_weight: Of the squared distance to the posture, where one is set [m^2/rad^2].
        smoothness: Of the squared distance to the last answer, in what the search is pulled to
            [m^2/rad^2].

    Raises:
        ValueError: A number is out of range, or the solver's method is "paper".
    """

    solver: Final[Solver]
    settings: Final[dict[str, Any]]

    def __init__(
        self,
        solver: Solver,
        period: float = 0.001,
        *,
        max_time: float | None = None,
        speed_share: float = 1.0,
        max_speed: ArrayLike | None = None,
        max_acceleration: ArrayLike | None = None,
        posture_weight: float = 1e-3,
        smoothness: float = 1e-4,
    ) -> None:
        if max_time is not None and not max_time > 0:
            raise ValueError(f"max_time is {max_time}, expected a positive time [s]")
        settings: dict[str, Any] = {
            "period": period,
            "max_time": max_time or 0.0,
            "speed_share": speed_share,
            "max_speed": max_speed,
            "max_acceleration": max_acceleration,
            "posture_weight": posture_weight,
            "smoothness": smoothness,
        }
        super().__init__(solver.robot, to_core(solver.options), **settings)
        self.solver, self.settings = solver, settings

    @once_made
    def __repr__(self) -> str:
        return f"<Tracker of {self.robot!r}, {self.latency!r}>"
