"""One motor that moves two joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ...motion import Columns, Motion, Place, Shape
from ...simulation import Coupling, Part
from ..effect import Effect, Example, Parameter, on_torque_and_tip, tip_turned
from ..site import Site


class JointCoupling(Effect):
    """True q_k = q_k + r q_j; motor j also carries r tau_k. Joints are (k, j)."""

    id = "joint_coupling"
    family = "transmission"
    on = "joint"
    equation = "q_k,true = q_k + r q_j; tau_j,motor = tau_j + r tau_k"
    parameters = (Parameter("ratio", "-", lower=-1.5, upper=1.5),)
    confused_with = ("kinematic_error", "joint_offset", "link_inertial_error")
    decided_by = "motion of joint j alone while the tip's pose is measured"
    source = "virtual work of a coupled transmission"
    example = Example(values={"ratio": 0.05}, place=Place(joints=(2, 1)))
    complexity = 3
    together = True

    def places(self, motions: Sequence[Motion]) -> list[Place]:
        """Neighbours, both ways."""
        body = motions[0].body
        return [] if body is None else [Place(joints=pair) for pair in body.neighbours()]

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Derivatives by joint k's position times joint j's, and the torque handed to motor j."""
        k, j = place.joints
        q = motion.q[:, j]
        change = motion.by_motion(k, q, motion.dq[:, j], motion.ddq[:, j])
        change[:, j] += motion.tau_without_rotor()[:, k]  # rotor k turns with its own motor
        return on_torque_and_tip(motion, change, tip_turned(motion, k, q))

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        if len(site.joints) != 2:
            got = ", ".join(site.joints) or "none"
            raise ValueError(f"{self.id} needs two joints, got {got}")
        return (Coupling(joint=site.joints[0], by=site.joints[1], ratio=site["ratio"]),)

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return (
            f"{where} are coupled: a turn of the second moves the first by {values['ratio']:.3g}."
        )
