"""What turns a command into torque: delays, lags, gains, limits."""

from .actuator_lag import ActuatorLag
from .command_delay import OF_POSITION, OF_TORQUE, CommandDelay, period_of
from .torque_channel import OF_BOTH, OF_DRIVE, OF_REPORT
from .torque_gain import TorqueGain
from .torque_offset import TorqueOffset
from .torque_saturation import (
    OF_COMMAND,
    OF_LAW,
    OF_REPORTED,
    TorqueSaturation,
    is_cut,
    kinds,
    top_of,
)
from .torque_speed_limit import TorqueSpeedLimit, speed_torque_limit_of

__all__ = [
    "OF_BOTH",
    "OF_COMMAND",
    "OF_DRIVE",
    "OF_LAW",
    "OF_POSITION",
    "OF_REPORT",
    "OF_REPORTED",
    "OF_TORQUE",
    "ActuatorLag",
    "CommandDelay",
    "TorqueGain",
    "TorqueOffset",
    "TorqueSaturation",
    "TorqueSpeedLimit",
    "is_cut",
    "kinds",
    "period_of",
    "speed_torque_limit_of",
    "top_of",
]
