"""Height fields as closed meshes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
Faces = npt.NDArray[np.int64]


def mesh_of_heights(
    heights: npt.ArrayLike, cell: npt.ArrayLike, bottom: float | None = None
) -> tuple[FloatArray, Faces]:
    """Vertices (V, 3) [m] and triangles (T, 3), counter-clockwise seen from outside.

    A cell is cut from its corner at the origin's side to the one across, as MuJoCo cuts its own.

    Args:
        heights: heights[i, j] stands at x = i cell, y = j cell, shape (I, J) [m].
        cell: From one to the next along x and y [m]: one number, or two.
        bottom: Height of the underside [m]. None for as far below the lowest as the field is long.

    Raises:
        ValueError: Names what is wrong: a shape, a height that is not finite, a bottom above them.
    """
    z = np.asarray(heights, dtype=np.float64)
    if z.ndim != 2 or min(z.shape) < 2:
        raise ValueError(f"heights have shape {z.shape}, expected two rows and columns at least")
    if not np.isfinite(z).all():
        place = tuple(np.argwhere(~np.isfinite(z))[0].tolist())
        raise ValueError(
            f"heights[{place[0]}, {place[1]}] is {z[place]}: fill what was not seen, or give what"
            " is known as a cloud"
        )
    steps = np.asarray(cell, dtype=np.float64)
    if steps.shape not in ((), (2,)) or not (np.isfinite(steps) & (steps > 0)).all():
        raise ValueError(f"cell is {cell!r}, expected one or two distances above 0 m")
    x, y = (step * at for step, at in zip(steps * np.ones(2), np.indices(z.shape), strict=True))
    low = float(z.min())
    under = low - max(x.max(), y.max()) if bottom is None else float(bottom)
    if not under < low:
        raise ValueError(f"bottom is {bottom}, expected one below the lowest height, {low:g}")
    top = np.arange(z.size).reshape(z.shape)
    a, b, c, d = top[:-1, :-1], top[1:, :-1], top[1:, 1:], top[:-1, 1:]
    ring = np.concatenate([top[:-1, 0], top[-1, :-1], top[:0:-1, -1], top[0, :0:-1]])
    below = z.size + np.arange(len(ring))
    after, below_after = np.roll(ring, -1), np.roll(below, -1)
    middle = np.full(len(ring), z.size + len(ring))
    surface = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    edge = surface[ring]
    edge[:, 2] = under
    faces = [(a, b, c), (a, c, d), (below, below_after, after), (below, after, ring),
             (middle, below_after, below)]  # fmt: skip
    return (
        np.vstack([surface, edge, [[x.max() / 2, y.max() / 2, under]]]),
        np.vstack([np.stack(corners, axis=-1).reshape(-1, 3) for corners in faces]),
    )
