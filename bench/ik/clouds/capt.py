"""VAMP's point clouds, its Collision-Affording Point Tree, through bench/ik/peers/vamp."""

import ctypes
from ctypes import POINTER, byref, c_double, c_float, c_int, c_ubyte, c_void_p
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from bench.common.arrays import BoolArray, FloatArray
from bench.common.peer_library import build

CAPT = "VAMP's CAPT"
FILTERED = "VAMP's CAPT, 20 mm filter"
MOST_UNFILTERED = 100_000  # a million of this scene do not fit into 8 GB of address space
# The filter's distance and a point's radius [m]: none, and those of VAMP's own benchmark.
SETTINGS = {CAPT: (0.0, 0.0), FILTERED: (0.02, 0.0025)}
FLOATS, DOUBLES = POINTER(c_float), POINTER(c_double)
QUESTION = (c_void_p, FLOATS, c_int, POINTER(c_ubyte), DOUBLES)
FUNCTIONS = {  # what they return and take
    "capt_create": (c_void_p, (FLOATS, c_int, c_float, c_float, POINTER(c_int), DOUBLES)),
    "capt_destroy": (None, (c_void_p,)),
    "capt_validate": (None, QUESTION),
    "capt_validate_lanes": (None, QUESTION),
}


def build_capt(directory: Path, vamp: Path) -> Path:
    """Build it in CMake's folder from VAMP's sources, and say where it is.

    Raises:
        RuntimeError: There are no such sources, or the compiler failed.
    """
    if not (vamp / "src/impl/vamp/collision/capt.hh").is_file():
        raise RuntimeError(f"{vamp} does not hold the sources of vamp-planner")
    folder = build(directory, "pdoik_capt", VAMP_SOURCE=vamp.resolve())
    return folder / "peers" / "libpdoik_capt.so"


class Capt:
    """Points, in single precision, (N, 3) [m], and Panda's spheres; by a name of SETTINGS."""

    def __init__(self, library: str, name: str, points: npt.NDArray[np.float32]) -> None:
        self._library = ctypes.CDLL(library)
        for function, (returned, taken) in FUNCTIONS.items():
            declared = getattr(self._library, function)
            declared.restype, declared.argtypes = returned, taken
        seconds, kept = c_double(), c_int()
        start = points.ctypes.data_as(FLOATS)
        outputs = byref(kept), byref(seconds)
        self._handle = self._library.capt_create(start, len(points), *SETTINGS[name], *outputs)
        self.time = seconds.value  # of making it, filter included [s]
        self.kept = kept.value  # points that the filter left
        self.lanes = int(self._library.capt_lanes())

    def validate(self, q: FloatArray) -> tuple[BoolArray, FloatArray]:
        """Whether each is free of points and of itself, and each call's time [s]."""
        return self._asked(self._library.capt_validate, q, len(q))

    def validate_lanes(self, q: FloatArray) -> tuple[BoolArray, FloatArray]:
        """The same for as many configurations in a call as there are lanes, one word for all."""
        return self._asked(self._library.capt_validate_lanes, q, len(q) // self.lanes)

    def _asked(self, function: Any, q: FloatArray, calls: int) -> tuple[BoolArray, FloatArray]:
        rows = np.ascontiguousarray(q, dtype=np.float32)
        free, seconds = np.zeros(calls, dtype=np.uint8), np.zeros(calls)
        arrays = zip((rows, free, seconds), (FLOATS, POINTER(c_ubyte), DOUBLES), strict=True)
        asked, *outputs = (array.ctypes.data_as(kind) for array, kind in arrays)
        function(self._handle, asked, calls, *outputs)
        return free.astype(bool), seconds

    def __del__(self) -> None:
        if getattr(self, "_handle", None):
            self._library.capt_destroy(self._handle)


def settings_for(count: int) -> list[str]:
    """The names to time among so many points."""
    return [name for name in SETTINGS if name != CAPT or count <= MOST_UNFILTERED]
