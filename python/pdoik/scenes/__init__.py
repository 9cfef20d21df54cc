"""Scenes from files and back: a file comes in, a `pdoik.Scene` goes out.

`load` looks at the suffix and hands the file to the reader of its format: `own_yaml`, `mjcf`,
`sdf`, `moveit_yaml`, `moveit_text`. Each gives a `World` (`asked`) of `pieces`: shapes are made of
them, and `plausible` looks at the whole.
"""

from pdoik.scenes.load import SceneFile, load_scene, read_scene_file
from pdoik.scenes.save import save_scene

from .contacts import as_optional, read_matrix
from .moveit_yaml import read_attached, read_world
from .pieces import Piece, Thing, mesh, shapes_of
from .values import EntryError, numbers, read_pose, read_text, read_yaml, rotation

__all__ = [
    "EntryError",
    "Piece",
    "SceneFile",
    "Thing",
    "as_optional",
    "load_scene",
    "mesh",
    "numbers",
    "read_attached",
    "read_matrix",
    "read_pose",
    "read_scene_file",
    "read_text",
    "read_world",
    "read_yaml",
    "rotation",
    "save_scene",
    "shapes_of",
]
