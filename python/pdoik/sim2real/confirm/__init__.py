"""What was identified, compared with simulations of the whole arm.

Comes in: `Identified`. Goes out: another, in which names that a regression confuses are
distinguished by rollouts, and figures are moved to where rollouts leave least. Next: infer.
"""

from .confirm_by_simulation import confirmed_by_simulation, run_without
from .refine_by_rollouts import refine_by_rollouts, simulated_estimates
from .rollouts import Arm, Rollout, why_not

__all__ = [
    "Arm",
    "Rollout",
    "confirmed_by_simulation",
    "refine_by_rollouts",
    "run_without",
    "simulated_estimates",
    "why_not",
]
