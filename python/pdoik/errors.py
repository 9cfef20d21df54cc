"""What pdoik raises and warns of."""


class PdoikError(Exception):
    """Base of pdoik's own exceptions. Misused arguments raise plain ValueError or TypeError."""


class LoadError(PdoikError, ValueError):
    """A file or text cannot be read as what it should be; the message names the element."""


class MissingExtraError(PdoikError, ModuleNotFoundError):
    """What was asked for needs a package that is not installed; the message says which extra."""

    def __init__(self, package: str, extra: str) -> None:
        super().__init__(f"{package} is not installed: pip install 'pdoik[{extra}]'", name=package)


class RobotWarning(UserWarning):
    """A robot's description is odd in a way that does not stop kinematics."""


class ObstacleWarning(UserWarning):
    """Obstacles are given in a way that is a mistake, most likely."""


class GoalWarning(UserWarning):
    """A goal or a start is given in a way that is a mistake, most likely; it is taken as given."""


class OverhangWarning(UserWarning):
    """The capsules that hold a link stick out farther than they should."""
