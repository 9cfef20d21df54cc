"""What reads a machine: encoders, clocks, an IMU."""

from .imu import ImuOffset, ImuTilt
from .joint_offset import JointOffset
from .sensor_gain import SensorGain, law_of_position
from .sensor_noise import SensorNoise
from .timestamp_skew import TimestampSkew

__all__ = [
    "ImuOffset",
    "ImuTilt",
    "JointOffset",
    "SensorGain",
    "SensorNoise",
    "TimestampSkew",
    "law_of_position",
]
