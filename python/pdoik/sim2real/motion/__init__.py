"""What moved, and what the model says of it.

Comes in: a `Study`. Goes out: `Prepared`, with a smooth `Motion` for each recording and `Balances`:
what was measured less what the model says, through one filter, with noise floors. Next: channels.
"""

from .balances import Balances, axis_of, columns_of
from .base_motion import CarriedBody, base_motion_of
from .ceiling import Ceiling, ceiling_of, pile_at
from .feet import FootMotion
from .foot_forces import with_ground
from .free_rows import directions_of
from .given_sessions import given_sessions
from .motion import Motion, motion_of, thinned
from .motion_noise import ImuNoise, chosen_cutoff, noise_of
from .place import Balance, Columns, Gate, Key, Place, Shape, tilt_key
from .prepare import Prepared, motions_of, prepare, simulated
from .rigid_body import STANDARD_GRAVITY, RigidBody
from .signals import derivative, dilated, lagged, noise_density, shifted, zero_phase
from .torque_limits import FlatTop, SpeedTorqueLimit, Torques, flat_top, speed_torque_limit
from .turned import torque_turned

__all__ = [
    "STANDARD_GRAVITY",
    "Balance",
    "Balances",
    "CarriedBody",
    "Ceiling",
    "Columns",
    "FlatTop",
    "FootMotion",
    "Gate",
    "ImuNoise",
    "Key",
    "Motion",
    "Place",
    "Prepared",
    "RigidBody",
    "Shape",
    "SpeedTorqueLimit",
    "Torques",
    "axis_of",
    "base_motion_of",
    "ceiling_of",
    "chosen_cutoff",
    "columns_of",
    "derivative",
    "dilated",
    "directions_of",
    "flat_top",
    "given_sessions",
    "lagged",
    "motion_of",
    "motions_of",
    "noise_density",
    "noise_of",
    "pile_at",
    "prepare",
    "shifted",
    "simulated",
    "speed_torque_limit",
    "thinned",
    "tilt_key",
    "torque_turned",
    "with_ground",
    "zero_phase",
]
