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

Build = Callable[[npt.NDArray[Any]], Any]

VOXEL = 0.01  # edge of the octree's [m]
THINNED_LEAF = 0.02  # [m]
LEAF_SIZE = 10  # of nanoflann's


def cloud(points: npt.NDArray[Any]) -> pdoik.Cloud:
    """Ours; it reads single and double precision in place."""
    return pdoik.Cloud(points)


def thinned(points: FloatArray) -> pdoik.Cloud:
    """Ours, one point for each cell of a grid."""
    return pdoik.Cloud(points, leaf=THINNED_LEAF)


def octree(points: FloatArray, voxel: float = VOXEL) -> Any:
    """OctoMap's tree in coal's wrapping: voxels that hold a point are occupied."""
    return import_module("coal").makeOctree(points, voxel)


def scipy_tree(points: FloatArray) -> Any:
    """SciPy's k-d tree."""
    return import_module("scipy.spatial").cKDTree(points, copy_data=True)


def nanoflann_tree(points: FloatArray) -> Any:
    """The k-d tree of nanoflann, from C++; it keeps the array."""
    tree = import_module("pynanoflann").KDTree(leaf_size=LEAF_SIZE)
    tree.fit(points.copy())
    return tree


OURS = "pdoik.Cloud"
OURS_SINGLE = "pdoik.Cloud, float32"
OURS_THINNED = f"pdoik.Cloud, {1e3 * THINNED_LEAF:.0f} mm leaf"
COAL = f"coal octree, {1e3 * VOXEL:.0f} mm"
SCIPY = "SciPy cKDTree"
NANOFLANN = "nanoflann"

STRUCTURES: Mapping[str, Build] = {
    OURS: cloud,
    OURS_SINGLE: cloud,
    OURS_THINNED: thinned,
    COAL: octree,
    SCIPY: scipy_tree,
    NANOFLANN: nanoflann_tree,
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
