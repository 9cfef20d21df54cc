"""Contact within a capsule's overhang is forgiven to who asks for it, and named."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import pdoik
from references import clearance, judged_occupancy

READY = (0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785)
FORGIVING = pdoik.Options(max_time=5.0, forgive_overhang=True)


def panda(options: pdoik.Options | None = None) -> pdoik.Solver:
    return pdoik.Solver(pdoik.Robot.builtin("panda"), options or pdoik.Options(max_time=5.0))


def table(top: float = -0.005) -> list[pdoik.Shape]:
    """Below the base, by less than its capsules stand beyond it."""
    return [pdoik.Shape.half_space("table", (0, 0, 1), (0, 0, top))]


def deepest(solver: pdoik.Solver, q: np.ndarray, points: np.ndarray) -> float:
    """By how much whole capsules touch that count as thinner, by code of the tests' own."""
    robot = solver.robot
    thin = judged_occupancy(robot).capsules
    whole = robot.occupancy.capsules
    placed = [full for full, less in zip(whole, thin, strict=True) if full[3] != less[3]]
    poses = {link: robot.fk(q, link) for link in robot.link_names}
    gap = clearance(pdoik.Occupancy(capsules=placed), poses, points)
    options = solver.options
    return max(0.0, options.clearance - options.clearance_tolerance - gap)


def test_an_arm_close_above_its_table_has_to_ask_for_it() -> None:
    usual, asked = panda(), panda(FORGIVING)
    T = usual.robot.fk(READY)
    refused = usual.solve(T, q0=READY, obstacles=table())
    assert (refused.status, refused.forgiven_contact, refused.forgiven_depth) == (
        "base_collision",
        "",
        0.0,
    )
    assert "panda_link0" in refused.worst_constraint
    result = asked.solve(T, q0=READY, obstacles=table())
    assert result.success
    assert result.forgiven_contact.startswith("clearance of panda_link0 (capsule ")
    assert result.forgiven_contact.endswith("to table")
    assert result.forgiven_depth == pytest.approx(refused.worst_violation, abs=1e-9)
    assert 0.0 < result.forgiven_depth < 0.015
    assert f"forgiven={result.forgiven_contact}" in repr(result)
    assert "forgiven" not in repr(refused)
    apart = asked.solve(T, q0=READY, obstacles=table(-0.1))
    assert apart.success
    assert (apart.forgiven_contact, apart.forgiven_depth) == ("", 0.0)


@pytest.mark.parametrize("seed", range(3))
def test_what_is_said_is_what_whole_capsules_touch(
    robot: pdoik.Robot, seed: int, rng: np.random.Generator
) -> None:
    options = pdoik.Options(clearance=(0.0, 0.004, -0.002)[seed], forgive_overhang=True)
    solver, named = pdoik.Solver(robot, options), 0
    for _ in range(25):
        q = rng.uniform(np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi))
        T = robot.fk(q)
        near = np.concatenate([T[:3, 3] + rng.uniform(-0.1, 0.1, (10, 3)), [(0.0, 0.0, -0.01)]])
        points = np.column_stack([near, rng.uniform(0.0, 0.01, len(near))])
        said = solver.judge(T, q, obstacles=points)
        assert said.forgiven_depth == pytest.approx(deepest(solver, q, points), abs=1e-8)
        assert bool(said.forgiven_contact) == (said.forgiven_depth > 0.0)
        named += bool(said.forgiven_contact)
    assert named > 3


def test_it_is_in_batches_pickles_and_steps() -> None:
    solver = panda(FORGIVING)
    T = solver.robot.fk(READY)
    batch = solver.solve_batch(np.stack([T] * 3), q0=READY, obstacles=table())
    assert all(name.endswith("to table") for name in batch.forgiven_contact)
    assert batch.forgiven_depth.shape == (3,)
    assert (batch.forgiven_depth > 0.0).all()
    again = pickle.loads(pickle.dumps(batch[0]))
    assert again.forgiven_contact == batch[0].forgiven_contact
    assert again.forgiven_depth == batch[0].forgiven_depth
    tracker = pdoik.Tracker(solver)
    tracker.reset(READY)
    step = tracker.step(T, obstacles=table())
    assert step.tracking == "tracking"
    assert step.forgiven_contact.endswith("to table")


def test_a_report_says_so_and_its_judge_finds_what_is_not_named(tmp_path: Path) -> None:
    solver = panda(FORGIVING)
    case = tmp_path / "case.json"
    T = solver.robot.fk(READY)
    floor = np.array([(x, y, 0.0) for x in (-0.1, 0.0) for y in (-0.05, 0.05)])
    pdoik.write_report(case, solver, T, q0=READY, obstacles=floor)
    replay = pdoik.replay_report(case)
    assert replay.faults == []
    assert replay.same
    depth = replay.answers[0]["forgiven_depth"]
    assert depth > 0.0
    text = case.read_text()
    case.write_text(text.replace(f'"forgiven_depth": {depth!r}', '"forgiven_depth": 0.0'))
    assert case.read_text() != text
    (fault,) = pdoik.replay_report(case).faults
    assert "is forgiven, by 0 m; it is " in fault
