"""Every number that decides what a diagnosis says: comes in with a study, goes to every stage."""

from .thresholds import Thresholds

__all__ = ["Thresholds"]
