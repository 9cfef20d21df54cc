"""Every IK method that is compared, by the name it has in the tables.

Each is imported when it is made, so that a method whose packages are missing costs nothing.
"""

import importlib
from pathlib import Path

from bench.ik.experiment import Arm
from bench.ik.methods.problem import Answer, Goal, Method, Problem, Terms

__all__ = ["METHODS", "Answer", "Goal", "Method", "Problem", "Terms", "make_method"]

METHODS = {
    "PDO-IK": "ours:PdoIk",
    "PDO-IK, omega = 0": "ours:PdoIkFromZeroSlack",
    "pdoik": "ours:PdoikDefault",
    "pdoik, capsules": "ours:PdoikCapsules",
    "pdoik, one start": "ours:PdoikOneStart",
    "pdoik, L-BFGS": "ours:PdoikLbfgs",
    "Angle-LBFGS-B": "scipy_lagrangian:AngleLbfgsB",
    "Slack-LBFGS": "scipy_lagrangian:SlackLbfgs",
    "R-TR": "distance_geometry:RiemannianTrustRegion",
    "R-CG": "distance_geometry:RiemannianConjugateGradient",
    "LM on Pinocchio": "compiled:PinocchioLm",
    "KDL LMA": "compiled:KdlLma",
    "ik_LM": "toolbox_lm:ToolboxLm",
    "Drake SNOPT": "drake_snopt:DrakeSnopt",
    "mink": "mink_qp:MinkQp",
}
PAPER_METHODS = (
    *("PDO-IK", "PDO-IK, omega = 0", "pdoik", "pdoik, capsules"),
    *("Angle-LBFGS-B", "Slack-LBFGS", "R-TR", "R-CG"),
)
PEERS = ("LM on Pinocchio", "KDL LMA", "ik_LM", "Drake SNOPT", "mink")
COMPILED = ("LM on Pinocchio", "KDL LMA")  # they come from the folder that build_peers gives


def make_method(name: str, arm: Arm, terms: Terms, libraries: Path | None = None) -> Method:
    """A method by its name in METHODS, for an arm's kinematics, limits and hulls.

    Raises:
        ImportError: It needs a package that is not installed.
        ValueError: It does not know such goals.
    """
    module, class_name = METHODS[name].split(":")
    found = importlib.import_module(f"bench.ik.methods.{module}")
    setup = {"libraries": libraries} if name in COMPILED else {}
    return getattr(found, class_name)(arm, terms, **setup)
