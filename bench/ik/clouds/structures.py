"""What a cloud can be kept in: ours, and what users would take instead.

Each is made from points in double precision, (N, 3), but for the one that says otherwise, and keeps
nothing of the caller's array, so that its memory is all that it needs.
"""

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any

import numpy as np
import numpy.typing as npt

import pdoik
from bench.common.arrays import FloatArray

VOXEL = 0.01  # edge of the octree's [m]
THINNED_LEAF = 0.02  # [m]
LEAF_SIZE = 10  # of nanoflann's

OURS = "pdoik.Cloud"
OURS_SINGLE = "pdoik.Cloud, float32"  # it reads single and double precision in place
OURS_THINNED = f"pdoik.Cloud, {1e3 * THINNED_LEAF:.0f} mm leaf"
COAL = f"coal octree, {1e3 * VOXEL:.0f} mm"
SCIPY = "SciPy cKDTree"
NANOFLANN = "nanoflann"


def octree(points: FloatArray) -> Any:
    """OctoMap's tree in coal's wrapping: voxels that hold a point are occupied."""
    return import_module("coal").makeOctree(points, VOXEL)


def scipy_tree(points: FloatArray) -> Any:
    """SciPy's k-d tree."""
    return import_module("scipy.spatial").cKDTree(points, copy_data=True)


def _nanoflann_tree(points: FloatArray) -> Any:
    """A k-d tree in C++; it keeps the array."""
    tree = import_module("pynanoflann").KDTree(leaf_size=LEAF_SIZE)
    tree.fit(points.copy())
    return tree


STRUCTURES: Mapping[str, Callable[[npt.NDArray[Any]], Any]] = {
    OURS: pdoik.Cloud,
    OURS_SINGLE: pdoik.Cloud,
    OURS_THINNED: lambda points: pdoik.Cloud(points, leaf=THINNED_LEAF),
    COAL: octree,
    SCIPY: scipy_tree,
    NANOFLANN: _nanoflann_tree,
}


def as_wanted(name: str, points: FloatArray) -> npt.NDArray[Any]:
    """The points in the structure's precision."""
    return points.astype(np.float32) if name == OURS_SINGLE else points


def missing(name: str) -> str | None:
    """Why a structure cannot be made here; None if it can."""
    try:
        STRUCTURES[name](as_wanted(name, np.zeros((1, 3))))
    except ImportError as error:
        return str(error)
    return None
