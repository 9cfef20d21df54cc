"""Gazebo's worlds: a file comes in, its obstacles go out (`World`).

`include` puts a world together from the files that it names, `state` moves what an older editor has
moved, `frames` says where everything is, `geometry` what it is, and `world` what counts.
"""

from pdoik.scenes.sdf.world import read_sdf

__all__ = ["read_sdf"]
