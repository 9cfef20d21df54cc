"""Whether a body is inside limits and touches nothing: Pinocchio's poses, NumPy's distances."""

import numpy as np

from bench.common.arrays import FloatArray
from bench.ik.goals.peers.body import Body
from bench.ik.goals.world import Kinematics, within
from bench.ik.judges.recheck import hull_clearance
from bench.ik.soak.hulls import segment_distance

TOUCHES = -1e-6 - 1e-9  # what is below [m]


class Judge:
    """Judges answers of one body."""

    def __init__(self, body: Body) -> None:
        self.kinematics = Kinematics(body.urdf, body.robot.joint_names)
        self._body = body
        self._radii = np.array([capsule.radius for capsule in body.capsules])
        of_link: dict[str, list[int]] = {}
        for k, capsule in enumerate(body.capsules):
            of_link.setdefault(capsule.link, []).append(k)
        pairs = [(i, j) for one, other in body.apart for i in of_link[one] for j in of_link[other]]
        self._pairs = np.array(pairs, dtype=int).reshape(-1, 2).T

    def holds(self, q: FloatArray) -> bool:
        """Whether limits do, and nothing touches; `kinematics` is at q then."""
        self.kinematics.place(q)
        return within(self._body.robot, q) and self.clearance() >= TOUCHES

    def clearance(self) -> float:
        """The least distance where `kinematics` is [m]."""
        body, least = self._body, np.inf
        if not body.has_contacts:
            return least
        poses = {link: self.kinematics.link(link) for link in body.robot.link_names}
        if len(body.points):
            least = hull_clearance(body.robot.occupancy, poses, body.points)
        a, b = (
            np.array([poses[c.link][:3, :3] @ end + poses[c.link][:3, 3] for c, end in ends])
            for ends in ([(c, c.a) for c in body.capsules], [(c, c.b) for c in body.capsules])
        )
        if body.table is not None:
            least = min(least, (np.minimum(a, b)[:, 2] - self._radii).min() - body.table)
        if body.self_collision:
            i, j = self._pairs
            gaps = segment_distance(a[i], b[i], a[j], b[j]) - self._radii[i] - self._radii[j]
            least = min(least, gaps.min())
        return float(least)
