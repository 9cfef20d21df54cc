"""The user's own simulator and the machine: what differs, and by which of its properties.

Comes in: a `Study` with a log of the simulator (`simulation:`), or its model (`simulator:`), and
recordings of the machine. Goes out: a `Comparison`, with runs paired by their commands, errors by
joint and frequency, findings in the simulator's own words, and a patch of its MJCF. The simulator
is taken as it is: candidates are copies of its model with other properties, run under the
recorded commands. Bases are fixed.

    from pdoik.sim2real.simulators import compare

    comparison = compare("study.yaml")
    for finding in comparison.machine.findings:
        print(finding.statement)
"""

from .candidates import ParameterId, baseline, model_with, terms_of
from .climb import Climb
from .commands import check_base_at_rest
from .compare import Comparison, compare
from .differences import differences_of, in_bands
from .experiment import Experiment, simulated
from .explain import Explained, explain
from .findings import Step, place_of, step_of
from .pairing import at_times_of, pairs_of
from .parameters import parameters_of
from .patch import patched
from .property import EVERY
from .scales import scales_of
from .user_model import UserModel, description_of, simulator_of, user_model
from .words import finding_line, headline
from .write import write

__all__ = [
    "EVERY",
    "Climb",
    "Comparison",
    "Experiment",
    "Explained",
    "ParameterId",
    "Step",
    "UserModel",
    "at_times_of",
    "baseline",
    "check_base_at_rest",
    "compare",
    "description_of",
    "differences_of",
    "explain",
    "finding_line",
    "headline",
    "in_bands",
    "model_with",
    "pairs_of",
    "parameters_of",
    "patched",
    "place_of",
    "scales_of",
    "simulated",
    "simulator_of",
    "step_of",
    "terms_of",
    "user_model",
    "write",
]
