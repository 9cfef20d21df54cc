"""Every number that decides what a diagnosis says: comes in with a study, goes to every stage."""

from .channels import ChannelThresholds
from .confidence import ConfidenceThresholds
from .controllers import ControllerThresholds
from .diagnosis import DiagnosisThresholds
from .feet import FeetThresholds
from .limits import LimitThresholds
from .noise import NoiseThresholds
from .priors import PriorThresholds
from .propose import ProposeThresholds
from .simulators import SimulatorThresholds
from .thresholds import Thresholds
from .watch import WatchThresholds

__all__ = [
    "ChannelThresholds",
    "ConfidenceThresholds",
    "ControllerThresholds",
    "DiagnosisThresholds",
    "FeetThresholds",
    "LimitThresholds",
    "NoiseThresholds",
    "PriorThresholds",
    "ProposeThresholds",
    "SimulatorThresholds",
    "Thresholds",
    "WatchThresholds",
]
