"""What comes in the middle of a computation: Ctrl-C, a signal's handler, the interpreter's end."""

import dataclasses
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
import pytest

import pdoik

LONG = pdoik.Options(max_time=20.0, max_restarts=2**31 - 1, prefer="nearest")
SOON = 5.0  # far less than any of these takes when nobody ends it [s]


@contextmanager
def handled(number: signal.Signals, by: Callable[[], object]) -> Iterator[None]:
    """Inside, the signal comes once, soon, and is handled by a call."""
    before = signal.signal(number, lambda *_: by())
    timer = threading.Timer(0.3, os.kill, (os.getpid(), number))
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()
        signal.signal(number, before)


def raise_interrupt() -> None:
    raise KeyboardInterrupt


@pytest.fixture
def solver(panda: pdoik.Robot) -> pdoik.Solver:
    return pdoik.Solver(panda, LONG)


@pytest.fixture(scope="module")
def panda() -> pdoik.Robot:
    return pdoik.Robot.builtin("panda")


@pytest.fixture
def target(panda: pdoik.Robot) -> np.ndarray:
    return panda.fk(panda.mid_configuration() + 0.1)


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("count", [2, 40])
def test_ctrl_c_ends_a_batch_of_long_solves_at_once(
    solver: pdoik.Solver, target: np.ndarray, count: int, threads: int
) -> None:
    started = time.monotonic()
    with handled(signal.SIGINT, raise_interrupt), pytest.raises(KeyboardInterrupt):
        solver.solve_batch(np.array([target] * count), threads=threads)
    assert time.monotonic() - started < SOON


def test_ctrl_c_is_heard_while_another_thread_has_the_solver(
    solver: pdoik.Solver, target: np.ndarray
) -> None:
    other = threading.Thread(target=solver.solve, args=(target,), daemon=True)
    other.start()
    time.sleep(0.1)
    started = time.monotonic()
    with handled(signal.SIGINT, raise_interrupt), pytest.raises(KeyboardInterrupt):
        solver.solve(target)
    assert time.monotonic() - started < SOON


def test_a_handler_that_asks_the_solver_it_interrupted_is_told_so(
    solver: pdoik.Solver, target: np.ndarray, panda: pdoik.Robot
) -> None:
    q = panda.mid_configuration()
    for asks in (
        lambda: solver.solve(target),
        lambda: solver.judge(target, q),
        lambda: solver.clearances(q),
        lambda: solver.solve_batch(np.array([target])),
        lambda: solver.detach(),
    ):
        started = time.monotonic()
        told = pytest.raises(RuntimeError, match="a handler needs a solver of its own")
        with handled(signal.SIGUSR1, asks), told:
            solver.solve(target)
        assert time.monotonic() - started < SOON


def test_a_handler_may_use_another_solver_and_change_the_cloud_that_is_solved_among(
    panda: pdoik.Robot, target: np.ndarray
) -> None:
    solver = pdoik.Solver(panda, dataclasses.replace(LONG, max_time=1.0))
    another = pdoik.Solver(panda)
    cloud = pdoik.Cloud([[2.0, 2.0, 2.0]])
    seen = []

    def use() -> None:
        for k in range(3):
            cloud.update([[3.0 + k, 3.0, 3.0]], [[-9, -9, -9], [9, 9, 9]])
        seen.append((another.solve(target, obstacles=cloud).success, len(cloud)))

    with handled(signal.SIGUSR1, use):
        assert solver.solve(target, obstacles=cloud).success
    assert seen == [(True, 1)]


ENDS = """
import threading, time
import numpy as np
import pdoik
robot = pdoik.Robot.builtin("ur10")
options = pdoik.Options(max_time=30.0, max_restarts=2**31 - 1, prefer="nearest")
solver = pdoik.Solver(robot, options)
T = robot.fk([0.1, -0.8, 1.0, 0.2, 0.3, 0.4])
points = np.random.default_rng(0).uniform(1.0, 2.0, (400_000, 3))
def work():
    while True:
        {work}
for _ in range(3):
    threading.Thread(target=work, daemon=True).start()
time.sleep(0.3)
print("ends", flush=True)
"""


@pytest.mark.parametrize(
    "work",
    [
        "solver.solve(T)",
        "solver.solve_batch(np.array([T] * 40))",
        "pdoik.Solver(robot, options).solve(T)",
        "solver.judge(T, robot.mid_configuration())",
        "pdoik.Cloud(points)",
        "pdoik.Cloud(points, leaf=0.05)",
    ],
)
def test_the_interpreter_ends_in_good_order_whatever_its_threads_compute(work: str) -> None:
    started = time.monotonic()
    ended = subprocess.run(
        [sys.executable, "-c", ENDS.format(work=work)], capture_output=True, text=True, timeout=60
    )
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "ends\n", "")
    assert time.monotonic() - started < 25.0


def test_what_is_registered_for_the_end_may_still_solve() -> None:
    program = """
import atexit
T = lambda: robot.fk(robot.mid_configuration())
atexit.register(lambda: print(pdoik.Solver(robot).solve(T()).success))
import pdoik
robot = pdoik.Robot.builtin("panda")
"""
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "True\n", "")


def test_a_child_process_does_not_wait_for_threads_of_its_parent() -> None:
    program = (
        ENDS.format(work="solver.solve(T)")
        + """
import os, sys, warnings
warnings.simplefilter("ignore")
if (child := os.fork()) == 0:
    sys.exit(7)
started = time.monotonic()
status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
print(status, time.monotonic() - started < 5.0)
"""
    )
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "ends\n7 True\n", "")
