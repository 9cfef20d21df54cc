"""The joints' controllers: their laws from commands, motion and effort; duties turned into torques.

Comes in: `Prepared`, whose controllers the study may know, know in part, or not at all. Goes out:
`ControllerCheck`, a `ControllerEstimate` for each joint, and the study with gains that were not
known, with torques in place of duties, and with the times at which drives have let go. Next:
channels.
"""
