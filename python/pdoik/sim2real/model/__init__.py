"""A robot with what was found of it: simulated, and asked for the torque that a motion needs.

Comes in: a study's robot and findings. Goes out: `Model`, written as model.json.
"""

from .healthy import CHARTS, VARIANCE, Healthy
from .model import FILE_NAME, Model, load_model, replay, robot_text
from .of_recording import held_part, simulator_in
from .predict import body_of, places_of, predict, torque_of, torques_along

__all__ = [
    "CHARTS",
    "FILE_NAME",
    "VARIANCE",
    "Healthy",
    "Model",
    "body_of",
    "held_part",
    "load_model",
    "places_of",
    "predict",
    "replay",
    "robot_text",
    "simulator_in",
    "torque_of",
    "torques_along",
]
