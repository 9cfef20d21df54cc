"""The solver."""

from typing import Final

from pdoik import _core
from pdoik._made import once_made
from pdoik._option_values import to_core
from pdoik.options import Options


class Solver(_core.Solver):
    """Constrained inverse kinematics among points (Sec. algorithm).

    It may be shared by threads, which then wait for each other; for work in parallel make one per
    thread, or use `solve_batch`.

    Args:
        robot: Copied: later changes to its occupancy do not reach the solver.
        options: What to aim at and how.

    Raises:
        ValueError: An option is out of range, or the robot has several tips or no joints.
    """

    options: Final[Options]

    def __init__(self, robot: _core.Robot, options: Options | None = None) -> None:
        options = options if options is not None else Options()
        super().__init__(robot, to_core(options))
        self.options = options

    @once_made
    def __repr__(self) -> str:
        return f"<Solver of {self.robot!r}, goal={self.options.goal!r}>"
