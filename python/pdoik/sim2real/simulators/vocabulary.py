"""The words that a simulator has, one class each, registered in `PROPERTIES`.

They are written into a candidate in this order. Everything else asks the registry.
"""

from __future__ import annotations

from . import body_words, drive_words, joint_words
from .property import Property

PROPERTIES: dict[str, Property] = {
    each.name: each
    for each in (
        joint_words.Damping(),
        joint_words.FrictionLoss(),
        joint_words.Armature(),
        drive_words.Kp(),
        drive_words.Kv(),
        drive_words.KpFactor(),
        drive_words.GainFactor(),
        joint_words.Stiffness(),
        joint_words.SpringTorque(),
        joint_words.Ref(),
        body_words.Mass(),
        body_words.CentreX(),
        body_words.CentreY(),
        body_words.CentreZ(),
        drive_words.Delay(),
        drive_words.Filter(),
        drive_words.ForceLimit(),
    )
}
