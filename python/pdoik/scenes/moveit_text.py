"""MoveIt's .scene files: the geometry of a planning scene as words on lines.

The scene's name on the first line; then for each object `* id`, in the newer layout its pose, the
number of its shapes, and for each of these type, numbers, position, quaternion (x y z w), colour;
in the newer layout the number of subframes, and for each its name and pose; `.` ends the file. As
MoveIt does, the layout is known from the line after the id: a pose has spaces, a number has not.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from pdoik.scenes.pieces import Kind, Piece, Thing, cone, mesh, plane
from pdoik.scenes.values import EntryError, read_text, rotation

FloatArray = npt.NDArray[np.float64]


def read_moveit_text(file: Path) -> list[Thing]:
    """The objects of a .scene file.

    Raises:
        EntryError: Names the line and the object.
    """
    text = _Words(file, read_text(file))
    text.skip_line()  # the scene's name
    things = []
    while (mark := text.word()) == "*":
        name = text.rest_of_line()
        text.where = f"object {name!r}"
        if not name:
            raise text.error("has no name")
        has_pose = len(text.peek()) > 1
        T = text.pose() if has_pose else np.eye(4)
        pieces = [_read_shape(text, T) for _ in range(text.count("shapes"))]
        if has_pose:
            for _ in range(text.count("subframes")):
                text.next_line()  # its name
                text.pose()
        things.append(Thing(name=name, pieces=tuple(pieces)))
        text.where = ""
    if mark != ".":
        raise text.error(f"expected '* id' or '.', got {mark!r}")
    return things


class _Words:
    """The file's words, one after the other.

    Attributes:
        where: The object that is read, for messages.
    """

    def __init__(self, file: Path, text: str) -> None:
        self.file = file
        self.where = ""
        self._lines = text.splitlines()
        self._line = 0  # that comes next
        self._words: list[str] = []  # left of the one before

    @property
    def entry(self) -> str:
        """Where the word was that was read last."""
        return ", ".join(filter(None, [f"line {self._line}", self.where]))

    def error(self, what: str) -> EntryError:
        return EntryError(self.file, what, self.entry)

    def peek(self) -> list[str]:
        """The words left on this line, or those of the next that has any."""
        while not self._words:
            if self._line >= len(self._lines):
                raise self.error("the file is cut short")
            self._words = self._lines[self._line].split()
            self._line += 1
        return self._words

    def skip_line(self) -> None:
        self._line += 1

    def word(self) -> str:
        return self.peek().pop(0)

    def rest_of_line(self) -> str:
        """The words left on this line, possibly none."""
        words, self._words = self._words, []
        return " ".join(words)

    def next_line(self) -> str:
        """The next line that has words, whole."""
        self.peek()
        return self.rest_of_line()

    def numbers(self, count: int) -> FloatArray:
        words = [self.word() for _ in range(count)]
        try:
            values = np.array(words, dtype=np.float64)
        except ValueError:
            values = np.full(count, np.nan)
        if not np.isfinite(values).all():
            raise self.error(f"expected {count} numbers, got {' '.join(words)!r}")
        return values

    def count(self, what: str) -> int:
        word = self.word()
        if not word.isdecimal():
            raise self.error(f"expected the number of {what}, got {word!r}")
        return int(word)

    def pose(self) -> FloatArray:
        T = np.eye(4)
        T[:3, 3] = self.numbers(3)
        T[:3, :3] = rotation(self.numbers(4), self.file, self.entry)
        return T


def _read_shape(text: _Words, T_base_object: FloatArray) -> Piece:
    kind, entry = text.word(), text.entry
    size, vertices, faces = np.empty(0), np.empty((0, 3)), np.empty((0, 3), dtype=np.int64)
    if kind == "mesh":
        n_vertices, n_faces = text.count("vertices"), text.count("triangles")
        vertices = np.array([text.numbers(3) for _ in range(n_vertices)]).reshape(-1, 3)
        rows = [[text.count("a vertex") for _ in range(3)] for _ in range(n_faces)]
        faces = np.array(rows, dtype=np.int64).reshape(-1, 3)
        if faces.size and faces.max() >= n_vertices:
            raise EntryError(text.file, "a triangle has a vertex that is not there", entry)
        if not n_vertices or not n_faces:
            raise EntryError(text.file, "a mesh without triangles", entry)
    elif kind in _NUMBERS:
        size = text.numbers(_NUMBERS[kind])
    else:
        raise EntryError(text.file, f"unknown type {kind!r}, expected {', '.join(_TYPES)}", entry)
    T = T_base_object @ text.pose()
    text.numbers(4)  # its colour
    try:
        if kind == "cone":
            return cone(size[0], size[1], T, entry)
        if kind == "plane":
            return plane(size, T, entry)
    except ValueError as error:
        raise EntryError(text.file, str(error), entry) from error
    if kind == "mesh":
        return mesh(vertices, faces, T, entry)
    return Piece(kind=_SOLIDS[kind], size=tuple(size.tolist()), T=T, entry=entry)


_SOLIDS: dict[str, Kind] = {"box": "box", "sphere": "sphere", "cylinder": "cylinder"}
_NUMBERS = {"box": 3, "sphere": 1, "cylinder": 2, "cone": 2, "plane": 4}
_TYPES = [*_NUMBERS, "mesh"]
