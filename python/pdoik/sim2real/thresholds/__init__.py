"""Every number that decides what a diagnosis says: comes in with a study, goes to every stage."""

from .table import (
    ChannelThresholds,
    ConfidenceThresholds,
    ControllerThresholds,
    DiagnosisThresholds,
    FeetThresholds,
    LimitThresholds,
    NoiseThresholds,
    PriorThresholds,
    ProposeThresholds,
    SimulatorThresholds,
    WatchThresholds,
)
from .thresholds import Thresholds

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
