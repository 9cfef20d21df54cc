"""The paper's objective for an optimiser of one's own."""

from typing import Final, Literal

from pdoik import _core
from pdoik._option_values import to_core
from pdoik.options import Options


class Lagrangian(_core.Lagrangian):
    """What method "paper" minimises (Eq. AL), evaluated by the C++ core, for any optimiser.

    >>> import numpy as np, scipy.optimize
    >>> import pdoik
    >>> robot = pdoik.Robot.builtin("panda")
    >>> objective = pdoik.Lagrangian(robot, variables="positions")
    >>> objective.set_target(robot.fk(robot.mid_configuration() + 0.1))
    >>> found = scipy.optimize.minimize(
    ...     objective, robot.mid_configuration(), args=(1.0,), jac=True, method="L-BFGS-B",
    ...     bounds=list(zip(robot.lower, robot.upper)))
    >>> bool(found.fun < 1e-6)
    True

    It belongs to one thread.

    Args:
        robot: Copied.
        options: Goal, clearance, point_distance and augmented_lagrangian.form count; the rest
            belongs to solvers.
        variables: "slack", the paper's omega, from which limits hold by themselves (one per joint:
            sub-angles that start equal stay equal); or "positions", q itself, whose limits are the
            optimiser's to hold.

    Raises:
        ValueError: An option is out of range, or the robot has several tips or no joints.
    """

    options: Final[Options]

    def __init__(
        self,
        robot: _core.Robot,
        options: Options | None = None,
        variables: Literal["slack", "positions"] = "slack",
    ) -> None:
        self.options = options if options is not None else Options()
        super().__init__(robot, to_core(self.options), variables)
