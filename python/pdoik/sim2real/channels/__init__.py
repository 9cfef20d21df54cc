"""Channels first: a wrong sign or unit, a model logged as a measurement, a noisy sensor.

Comes in: `Prepared`. Goes out: `ChannelCheck`, findings of channels and the study with what can be
mended mended. Next: select.
"""

from .check_channels import ChannelCheck, check_channels
from .factors_by_model import factors_by_model
from .noisy_channels import noisy_channels

__all__ = [
    "ChannelCheck",
    "check_channels",
    "factors_by_model",
    "noisy_channels",
]
