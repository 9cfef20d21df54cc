"""Scenes from files and back: a file comes in, a `pdoik.Scene` goes out.

`load` looks at the suffix and hands the content to the reader of its format: `own_yaml`,
`moveit_yaml` or `moveit_text`. Each gives pieces (`pieces`), which become shapes.
"""

from pdoik.scenes.load import SceneFile, load_scene, read_scene_file
from pdoik.scenes.own_yaml import save_scene

__all__ = ["SceneFile", "load_scene", "read_scene_file", "save_scene"]
