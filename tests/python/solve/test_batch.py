"""A batch is a loop: same answers, on any number of threads; its fields are columns."""

import os
import pickle
import signal
import threading

import numpy as np
import pytest

import pdoik
from samples import box_of_points, random_configuration, reachable_targets

FIELDS = (
    "q", "success", "status", "position_error", "rotation_error", "clearance", "limit_violation",
    "worst_constraint", "worst_violation", "iterations", "evaluations", "restarts",
)  # fmt: skip
OPTIONS = pdoik.Options(max_time=60.0, max_restarts=4)


def test_a_batch_is_a_loop_on_any_number_of_threads(
    robot: pdoik.Robot, rng: np.random.Generator
) -> None:
    targets = reachable_targets(robot, rng, 150)
    cloud = box_of_points(rng, 40)
    starts = np.stack([random_configuration(robot, rng) for _ in targets])
    solver = pdoik.Solver(robot, OPTIONS)
    for q0 in (None, starts[0], starts):
        each = starts if q0 is starts else [q0] * len(targets)
        loop = [
            solver.solve(T, q0=start, obstacles=cloud)
            for T, start in zip(targets, each, strict=True)
        ]
        for threads in (1, 2, 5):
            batch = solver.solve_batch(targets, q0=q0, obstacles=cloud, threads=threads)
            for name in FIELDS:
                expected = np.array([getattr(result, name) for result in loop])
                np.testing.assert_array_equal(getattr(batch, name), expected)


def test_columns_and_items_are_two_views_of_the_same(
    robot: pdoik.Robot, rng: np.random.Generator
) -> None:
    batch = pdoik.Solver(robot, OPTIONS).solve_batch(reachable_targets(robot, rng, 7))
    assert len(batch) == 7
    assert batch.q.shape == (7, robot.dof)
    assert batch.success.dtype == bool
    assert batch.time.shape == (7,)
    assert [result.status for result in batch] == batch.status.tolist()
    np.testing.assert_array_equal(batch[-1].q, batch.q[6])
    np.testing.assert_array_equal(np.stack([result.q for result in batch]), batch.q)
    assert f"{batch.success.sum()} of 7 solved" in repr(batch)
    for outside in (7, -8):
        with pytest.raises(IndexError):
            batch[outside]


def test_results_outlive_their_batch(robot: pdoik.Robot, rng: np.random.Generator) -> None:
    batch = pdoik.Solver(robot, OPTIONS).solve_batch(reachable_targets(robot, rng, 3))
    expected = batch.q
    items, iterator = [batch[i] for i in range(3)], iter(batch)
    del batch
    np.testing.assert_array_equal(np.stack([item.q for item in items]), expected)
    np.testing.assert_array_equal(np.stack([item.q for item in iterator]), expected)


def test_no_targets_give_no_results(robot: pdoik.Robot) -> None:
    batch = pdoik.Solver(robot).solve_batch(np.zeros((0, 4, 4)), obstacles=[[1.0, 0.0, 0.0]])
    assert len(batch) == 0
    assert batch.q.shape == (0, robot.dof)
    for name in FIELDS[1:]:
        assert getattr(batch, name).shape == (0,)


def test_a_result_survives_pickling(robot: pdoik.Robot, rng: np.random.Generator) -> None:
    target = reachable_targets(robot, rng, 1)[0]
    result = pdoik.Solver(robot, OPTIONS).solve(target, obstacles=box_of_points(rng, 10))
    copy = pickle.loads(pickle.dumps(result))
    for name in (*FIELDS, "time"):
        np.testing.assert_array_equal(getattr(copy, name), getattr(result, name))
    assert repr(copy) == repr(result)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"T_base_tip": np.eye(4)}, r"T_base_tip has shape \(4, 4\), expected \(B, 4, 4\)"),
        ({"T_base_tip": np.full((2, 4, 4), np.nan)}, "T_base_tip holds NaN"),
        ({"T_base_tip": np.zeros((2, 4, 4))}, r"T_base_tip\[0\] has a last row"),
        ({"q0": np.zeros(3)}, r"q0 has shape \(3,\), expected"),
        ({"q0": np.zeros((3, 7))}, "q0 has 3 rows, expected 1 or 2"),
        ({"q0": np.zeros((0, 7))}, "q0 has 0 rows, expected 1 or 2"),
        ({"q0": np.full((2, 7), np.inf)}, "q0 holds NaN or infinity"),
        ({"obstacles": [[0, 0, np.nan]]}, "obstacles holds NaN"),
        ({"threads": -1}, "threads is -1"),
    ],
)
def test_misuse_is_named(arguments: dict, message: str) -> None:
    solver = pdoik.Solver(pdoik.Robot.builtin("panda"))
    with pytest.raises(ValueError, match=message):
        solver.solve_batch(**{"T_base_tip": np.tile(np.eye(4), (2, 1, 1)), **arguments})


def test_ctrl_c_ends_a_long_batch(robot: pdoik.Robot) -> None:
    far = np.eye(4)
    far[0, 3] = 100.0
    solver = pdoik.Solver(robot, pdoik.Options(max_time=0.002, max_restarts=10**6))
    interrupt = threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT))

    def solve() -> None:
        interrupt.start()
        solver.solve_batch(np.tile(far, (100_000, 1, 1)))

    with pytest.raises(KeyboardInterrupt):
        solve()
    interrupt.join()
