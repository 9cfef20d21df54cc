"""Points of depth images, as cameras give them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

_FAR, _NEAR = 100.0, 0.02  # no depth camera's median is beyond [m]
_RIGID = 1e-6


def points_of_depth(
    image: npt.ArrayLike,
    K: npt.ArrayLike,
    T_base_camera: npt.ArrayLike | None,
    max_range: float | None,
    scale: float | None,
) -> FloatArray:
    """What a camera has seen, (N, 3) in the base frame [m]; see `Cloud.from_depth`."""
    depth = _depths(image, scale)
    if max_range is not None and not max_range > 0:
        raise ValueError(f"max_range is {max_range}, expected a positive length [m]")
    fx, fy, cx, cy = _intrinsics(K, depth.shape)
    T = _pose(T_base_camera)
    within = depth <= (np.inf if max_range is None else max_range)  # NaN is not
    v, u = np.nonzero(within & (depth > 0))
    z = depth[v, u]
    seen = np.column_stack([(u - cx) / fx * z, (v - cy) / fy * z, z])
    return np.ascontiguousarray(seen @ T[:3, :3].T + T[:3, 3])


def _depths(image: npt.ArrayLike, scale: float | None) -> FloatArray:
    """Metres, (H, W): NaN where nothing was seen."""
    array = np.asarray(image)
    if array.ndim == 3 and array.shape[2] == 1:
        array = array[:, :, 0]
    if array.ndim != 2 or array.dtype.kind not in "fiu":
        raise ValueError(
            f"image has shape {array.shape} and dtype {array.dtype}, expected depths (H, W)"
        )
    in_metres = array.dtype.kind == "f"
    if scale is not None and not (np.isfinite(scale) and scale > 0):
        raise ValueError(f"scale is {scale}, expected the metres of one unit")
    depth = array.astype(np.float64) * (scale or (1.0 if in_metres else 1e-3))
    depth[~np.isfinite(depth) | (depth <= 0)] = np.nan
    seen = depth[~np.isnan(depth)]
    if not seen.size:
        raise ValueError(
            f"image has {array.size} pixels, none with a depth above 0: a camera that saw nothing,"
            " which does not say that nothing is there"
        )
    middle = float(np.median(seen))
    if not _NEAR <= middle <= _FAR:
        raise ValueError(
            f"half of the image is {'more' if middle > _FAR else 'less'} than {middle:.3g} m away:"
            " is it in other units? Floats are taken as metres and whole numbers as millimetres;"
            " scale says how many metres a unit has"
        )
    return depth


def _intrinsics(K: npt.ArrayLike, shape: tuple[int, ...]) -> tuple[float, float, float, float]:
    """fx, fy, cx, cy [pixels]."""
    matrix = np.asarray(K, dtype=np.float64)
    if matrix.shape == (4,):
        fx, fy, cx, cy = matrix.tolist()
    elif matrix.shape in ((3, 3), (9,)):
        matrix = matrix.reshape(3, 3)
        if not np.allclose(matrix[[1, 2, 2, 2], [0, 0, 1, 2]], [0, 0, 0, 1]):
            raise ValueError("K is no matrix of a camera, [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]")
        if abs(matrix[0, 1]) > _RIGID * abs(matrix[0, 0]):
            raise ValueError("K has a skew, which depth cameras do not have")
        fx, fy, cx, cy = matrix[[0, 1, 0, 1], [0, 1, 2, 2]].tolist()
    else:
        raise ValueError(f"K has shape {matrix.shape}, expected (3, 3) or (4,): fx, fy, cx, cy")
    if not (np.isfinite([fx, fy]).all() and fx > 0 and fy > 0):
        raise ValueError(f"K has focal lengths {fx} and {fy}, expected positive ones [pixels]")
    height, width = shape
    if not (0 <= cx <= width and 0 <= cy <= height):
        raise ValueError(
            f"K has its middle at ({cx:g}, {cy:g}), outside the image of {width} x {height}: it is"
            " of another image size, perhaps"
        )
    return fx, fy, cx, cy


def _pose(T_base_camera: npt.ArrayLike | None) -> FloatArray:
    T = np.eye(4) if T_base_camera is None else np.asarray(T_base_camera, dtype=np.float64)
    if T.shape != (4, 4):
        raise ValueError(f"T_base_camera has shape {T.shape}, expected (4, 4)")
    R = T[:3, :3]
    is_rigid = (
        np.isfinite(T).all()
        and np.allclose(R @ R.T, np.eye(3), atol=_RIGID)
        and np.linalg.det(R) > 0
        and np.allclose(T[3], [0, 0, 0, 1])
    )
    if not is_rigid:
        raise ValueError("T_base_camera is no rigid transform")
    return T
