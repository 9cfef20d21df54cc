"""Robots the tests share."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

import pdoik
from references import PinocchioRobot

ROBOTS = Path(pdoik.__file__).parent / "robots"
SHIPPED = ("panda", "ur10", "iiwa14")

settings.register_profile("pdoik", deadline=None, derandomize=True, print_blob=True)
settings.load_profile("pdoik")


def pytest_report_header() -> str:
    return "seeds: fixed, 0 upwards; hypothesis derandomized"


@pytest.fixture
def rng(request: pytest.FixtureRequest) -> np.random.Generator:
    """Numbers that depend on the test's parameters only by their `seed`."""
    seed = getattr(request.node, "callspec", None)
    return np.random.default_rng(seed.params.get("seed", 0) if seed is not None else 0)


@pytest.fixture(params=SHIPPED)
def robot(request: pytest.FixtureRequest) -> pdoik.Robot:
    """Each shipped robot."""
    return pdoik.Robot.builtin(request.param)


@pytest.fixture
def pinocchio(robot: pdoik.Robot) -> PinocchioRobot:
    """Pinocchio's model of the same robot."""
    return PinocchioRobot.from_xml((ROBOTS / f"{robot.name}.urdf").read_text())
