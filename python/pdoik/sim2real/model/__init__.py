"""A robot with what was found of it: simulated, and asked for the torque that a motion needs.

Comes in: a study's robot and findings. Goes out: `Model`, written as model.json.
"""
