"""What the tests of trees share: the H1, its postures, and errors by plain matrices."""

import numpy as np
from scipy.spatial.transform import Rotation

import pdoik
from conftest import ROBOTS

H1_XML = (ROBOTS / "h1.urdf").read_text()
LEFT, RIGHT = "left_ankle_link", "right_ankle_link"
TIPS = [LEFT, RIGHT, "left_elbow_link", "right_elbow_link"]
# The budget of restarts ends it, on any machine; random targets may have no answer off itself.
PATIENT = {"max_time": 60.0, "max_restarts": 50, "self_collision": False}
SOLE = np.array([[0.17, 0.03], [0.17, -0.03], [-0.06, 0.03], [-0.06, -0.03]])
SOLE = np.column_stack([SOLE, np.full(4, -0.07)])  # corners in the ankle's frame [m]


def crouch(robot: pdoik.Robot) -> np.ndarray:
    """Knees bent, arms off the body: a posture that is free of self-collision."""
    angles = {"hip_pitch": -0.4, "knee": 0.8, "ankle": -0.4, "elbow": 0.6}
    q = np.zeros(robot.dof)
    for i, name in enumerate(robot.joint_names):
        part = name.removesuffix("_joint").removeprefix("left_").removeprefix("right_")
        q[i] = angles.get(part, 0.0)
        if part == "shoulder_roll":
            q[i] = 0.35 if name.startswith("left") else -0.35
    return q


def near(robot: pdoik.Robot, q: np.ndarray, rng: np.random.Generator, by: float) -> np.ndarray:
    return np.clip(q + rng.uniform(-by, by, robot.dof), robot.lower, robot.upper)


def by_name(robot: pdoik.Robot, q: np.ndarray) -> dict[str, float]:
    return dict(zip(robot.joint_names, q.tolist(), strict=True))


def errors(
    T_base_tip: np.ndarray,
    T: np.ndarray,
    position_slack: np.ndarray | float = 0.0,
    rotation_slack: np.ndarray | float = 0.0,
) -> tuple[float, float]:
    """Position and rotation error beyond slack along the target's axes."""
    off = T_base_tip[:3, :3].T @ (T[:3, 3] - T_base_tip[:3, 3])
    turn = Rotation.from_matrix(T_base_tip[:3, :3].T @ T[:3, :3]).as_rotvec()
    return (
        float(np.linalg.norm(np.maximum(np.abs(off) - position_slack, 0.0))),
        float(np.linalg.norm(np.maximum(np.abs(turn) - rotation_slack, 0.0))),
    )


def confirm_limits(robot: pdoik.Robot, result: pdoik.Result) -> None:
    assert np.isfinite(result.q).all()
    assert (robot.lower <= result.q).all()
    assert (result.q <= robot.upper).all()
    assert result.success == (result.status == "solved") == (result.worst_violation <= 0.0)
