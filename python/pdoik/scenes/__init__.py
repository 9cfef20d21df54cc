"""Scenes from files and back: a file comes in, a `pdoik.Scene` goes out.

`load` looks at the suffix and hands the file to the reader of its format: `own_yaml`, `mjcf`,
`sdf`, `moveit_yaml`, `moveit_text`. Each gives a `World` (`asked`) of `pieces`: shapes are made of
them, and `plausible` looks at the whole.
"""

from pdoik.scenes.load import SceneFile, load_scene, read_scene_file
from pdoik.scenes.save import save_scene

__all__ = ["SceneFile", "load_scene", "read_scene_file", "save_scene"]
