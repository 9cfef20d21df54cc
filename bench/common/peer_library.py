"""The peers of bench/ik/peers: built with CMake, loaded through ctypes, timed inside C++."""

from __future__ import annotations

import ctypes
import subprocess
import sys
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_uint, c_void_p
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

ROOT = Path(__file__).resolve().parents[2]


def build_peers(directory: Path) -> Path:
    """Build the peers with the Pinocchio of this Python, and say in which folder they are.

    Raises:
        RuntimeError: CMake or the compiler failed.
    """
    return build(directory, "pdoik_peers") / "peers"


def build(directory: Path, target: str, **definitions: object) -> Path:
    """Build what benchmarks run, and say in which folder.

    Args:
        directory: CMake's folder.
        target: What to build.
        definitions: For CMake's cache.

    Raises:
        RuntimeError: CMake or the compiler failed.
    """
    configure = ["cmake", "-S", str(ROOT), "-B", str(directory), "--log-level=WARNING"]
    options = ["-D", "PDOIK_BUILD_BENCH=ON", "-D", f"Python3_EXECUTABLE={sys.executable}"]
    options += [word for name, value in definitions.items() for word in ("-D", f"{name}={value}")]
    build = ["cmake", "--build", str(directory), "--parallel", "2", "--target", target]
    for command in (configure + options, build):
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        if run.returncode != 0:
            raise RuntimeError(f"{' '.join(command)}\n{run.stdout[-4000:]}{run.stderr[-4000:]}")
    return directory


class _Setup(ctypes.Structure):
    _fields_ = (
        ("urdf_path", c_char_p),
        ("tip_link", c_char_p),
        ("occupancy_yaml", c_char_p),
        ("axis_goal", c_int),
        ("position_tolerance", c_double),
        ("rotation_tolerance", c_double),
        ("clearance_tolerance", c_double),
        ("max_time", c_double),
        ("seed", c_uint),
    )


class _Problem(ctypes.Structure):
    _fields_ = (
        ("T_base_tip", POINTER(c_double)),
        ("q0", POINTER(c_double)),
        ("obstacles", POINTER(c_double)),
        ("obstacle_count", c_int),
        ("obstacle_columns", c_int),
    )


class _Answer(ctypes.Structure):
    _fields_ = (
        ("q", POINTER(c_double)),
        ("time", c_double),
        ("success", c_int),
        ("iterations", c_int),
        ("evaluations", c_int),
        ("restarts", c_int),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class PeerAnswer:
    """What a peer says of one problem."""

    q: FloatArray  # (n,), [rad]
    success: bool  # in its own opinion, and within max_time
    time: float  # [s]
    iterations: int
    evaluations: int  # forward kinematics; those of an obstacle check apart
    restarts: int


@dataclass(frozen=True, slots=True, kw_only=True)
class PeerSetup:
    """What a peer is made for."""

    urdf: Path
    tip_link: str
    occupancy_yaml: str | None = None  # for those that know obstacles
    goal: Literal["pose", "axis"] = "pose"  # "axis": position and direction of the tip's z
    position_tolerance: float  # [m]
    rotation_tolerance: float  # [rad]
    clearance_tolerance: float = 1e-6  # for peers that may come this near; others keep clear [m]
    max_time: float  # [s]
    seed: int = 1  # of the starts it draws


class Peer:
    """Another solver behind the functions of bench/ik/peers/peer.h.

    Args:
        library: libpdoik_peer_*.so.
        setup: What it is made for.
        dof: How many joints there are.

    Raises:
        RuntimeError: The library cannot be loaded, or it refuses.
    """

    def __init__(self, library: Path, setup: PeerSetup, dof: int) -> None:
        try:
            self._functions = _declared(ctypes.CDLL(str(library)))
        except OSError as error:
            raise RuntimeError(f"{library.name}: {error}") from error
        occupancy = setup.occupancy_yaml.encode() if setup.occupancy_yaml is not None else None
        self._handle = self._functions.peer_create(
            byref(
                _Setup(
                    str(setup.urdf).encode(),
                    setup.tip_link.encode(),
                    occupancy,
                    int(setup.goal == "axis"),
                    setup.position_tolerance,
                    setup.rotation_tolerance,
                    setup.clearance_tolerance,
                    setup.max_time,
                    setup.seed,
                )
            )
        )
        if not self._handle:
            raise RuntimeError(f"{library.name}: {self._functions.peer_error().decode()}")
        self._q = np.zeros(dof)

    def solve(
        self,
        T_base_tip: FloatArray,
        q0: FloatArray | None = None,
        obstacles: FloatArray | None = None,
    ) -> PeerAnswer:
        """One solve.

        Args:
            T_base_tip: The target, (4, 4).
            q0: The first start, (n,) [rad]; None for the peer's own.
            obstacles: Points, (N, 3), or (N, 4) with a radius each [m].

        Raises:
            ValueError: The obstacles have another shape, or q0 has.
            RuntimeError: The peer does not know this kind of problem.
        """
        T, start, points = (_contiguous(array) for array in (T_base_tip, q0, obstacles))
        if start is not None and start.shape != self._q.shape:
            raise ValueError(f"q0 has shape {start.shape}, expected {self._q.shape}")
        if points is not None and (points.ndim != 2 or points.shape[1] not in (3, 4)):
            raise ValueError(f"obstacles has shape {points.shape}, expected (N, 3) or (N, 4)")
        count, columns = (0, 3) if points is None else points.shape
        problem = _Problem(_pointer(T), _pointer(start), _pointer(points), count, columns)
        answer = _Answer(_pointer(self._q))
        if self._functions.peer_solve(self._handle, byref(problem), byref(answer)) != 0:
            raise RuntimeError("the peer does not know this kind of problem")
        return PeerAnswer(
            q=self._q.copy(),
            success=bool(answer.success),
            time=float(answer.time),
            iterations=int(answer.iterations),
            evaluations=int(answer.evaluations),
            restarts=int(answer.restarts),
        )

    def __del__(self) -> None:
        if getattr(self, "_handle", None):
            self._functions.peer_destroy(self._handle)


def _declared(library: ctypes.CDLL) -> Any:
    library.peer_create.restype = c_void_p
    library.peer_create.argtypes = (POINTER(_Setup),)
    library.peer_destroy.restype = None
    library.peer_destroy.argtypes = (c_void_p,)
    library.peer_error.restype = c_char_p
    library.peer_error.argtypes = ()
    library.peer_solve.restype = c_int
    library.peer_solve.argtypes = (c_void_p, POINTER(_Problem), POINTER(_Answer))
    return library


def _contiguous(array: FloatArray | None) -> FloatArray | None:
    return None if array is None else np.ascontiguousarray(array, dtype=np.float64)


def _pointer(array: FloatArray | None) -> Any:
    return None if array is None else array.ctypes.data_as(POINTER(c_double))
