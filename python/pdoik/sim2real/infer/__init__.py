"""What may be claimed: figures, intervals, confidence; then the judgement of held-out recordings.

Comes in: `Identified`. Goes out: `Examination`, a `Diagnosis` with all it rests on. Recordings held
out come in here, last, and change no finding. Next: evidence and report.
"""

from .answerable import why_unanswerable
from .conclude import Examination, conclude
from .events import event_support
from .figures import (
    at_bound,
    blur,
    lateness,
    shared_by_all,
    widened,
    with_torque_scale,
    within_bounds,
)
from .standing_out import spreads_of
from .verdict import preferred, residue_of, simulator_notes, source_in_words, verdict_of

__all__ = [
    "Examination",
    "at_bound",
    "blur",
    "conclude",
    "event_support",
    "lateness",
    "preferred",
    "residue_of",
    "shared_by_all",
    "simulator_notes",
    "source_in_words",
    "spreads_of",
    "verdict_of",
    "why_unanswerable",
    "widened",
    "with_torque_scale",
    "within_bounds",
]
