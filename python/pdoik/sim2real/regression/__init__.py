"""Effects fitted to balances: least squares of many terms, cross-validated.

Comes in: `Balances` and effects at places. Goes out: `Fit`s, what they say of other recordings, and
the findings that terms stand for.
"""

from .background import BACKGROUND, background, friction_at, imu_parts, is_scale, usual_torque
from .fit import Fit, Index, Term, TermKey, Weighted, term_of
from .improved_model import improved_model
from .naming import (
    Found,
    channel_of,
    described,
    finding_of,
    link_of,
    where_in_words,
    without_idle_gate,
)
from .prediction import Prediction, share_by_blocks
from .random_effects import Spread, spread_between
from .real_bodies import nearest, with_real_bodies
from .refine import OneMore, gains_alone, refined
from .second_order import to_second_order
from .trusted_bodies import DAYS, SCALE, SPEED, TRUST, ZERO, Tolerance, effect_of, trusted
from .wald import repeats, repeats_of, robust, wald

__all__ = [
    "BACKGROUND",
    "DAYS",
    "SCALE",
    "SPEED",
    "TRUST",
    "ZERO",
    "Fit",
    "Found",
    "Index",
    "OneMore",
    "Prediction",
    "Spread",
    "Term",
    "TermKey",
    "Tolerance",
    "Weighted",
    "background",
    "channel_of",
    "described",
    "effect_of",
    "finding_of",
    "friction_at",
    "gains_alone",
    "improved_model",
    "imu_parts",
    "is_scale",
    "link_of",
    "nearest",
    "refined",
    "repeats",
    "repeats_of",
    "robust",
    "share_by_blocks",
    "spread_between",
    "term_of",
    "to_second_order",
    "trusted",
    "usual_torque",
    "wald",
    "where_in_words",
    "with_real_bodies",
    "without_idle_gate",
]
