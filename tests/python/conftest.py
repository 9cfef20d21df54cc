"""Robots, studies and motions the tests share."""

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import settings

import pdoik
from references import PinocchioRobot

ROBOTS = Path(pdoik.__file__).parent / "robots"
SHIPPED = ("panda", "ur10", "iiwa14")

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # as where a shell starts them with nohup
    signal.signal(signal.SIGINT, signal.default_int_handler)

os.environ["PDOIK_CACHE"] = ""  # no test depends on what an earlier one has fitted

settings.register_profile("pdoik", deadline=None, derandomize=True, print_blob=True)
settings.load_profile("pdoik")


SLOWEST = (
    "test_view_page",
    "test_view_narrow",
    "test_readme",
    "test_soak",
    "test_inference",
)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files that take minutes come first, or one worker is left alone with one at the end."""
    items.sort(key=lambda item: item.path.stem not in SLOWEST)


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


@pytest.fixture(scope="session")
def motion(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Of an arm with three joints in space, every channel; needs the extra sim2real."""
    from sim2real_motions import moved, pd

    folder = tmp_path_factory.mktemp("arm")
    return moved(folder, 3, tip=True, controller=pd(3), seconds=10.0)


@pytest.fixture(scope="session")
def example_study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The study that bench/sim2real/example.py writes: friction at the elbow, a weight held."""
    pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
    folder = tmp_path_factory.mktemp("example") / "arm_study"
    program = Path(__file__).parents[2] / "bench/sim2real/example.py"
    subprocess.run([sys.executable, program, folder], check=True)
    return folder / "study.yaml"


@pytest.fixture(scope="session")
def examination(example_study: Path) -> Any:
    """What `examine` makes of it; made once, since it takes a few seconds."""
    for package in ("pinocchio", "pyarrow", "jinja2"):
        pytest.importorskip(package, reason="pip install 'pdoik[sim2real]'")
    from pdoik.sim2real import examine

    return examine(example_study)
