"""MuJoCo's models: a file comes in, its obstacles go out (`World`).

`bodies` distinguishes the robot from the rest, `geoms` makes pieces of what MuJoCo collides.
"""

from pdoik.scenes.mjcf.world import read_mjcf

__all__ = ["read_mjcf"]
