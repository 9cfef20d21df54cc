"""The Unitree H1 that dodges flying objects in MuJoCo (Sec. exp3).

World: x is the robot's left, so it faces -y; z is up and 0 at the ankles. Joint vectors are (19,)
in the order of `JOINT_NAMES`, which is that of `pdoik.Robot` seen from the left ankle.
"""
