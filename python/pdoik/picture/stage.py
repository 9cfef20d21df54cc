"""The cube of axes that a picture stands in, and where its points are among the pixels."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.axes3d import Axes3D  # type: ignore[import-untyped]
from PIL import Image

from .cube import Cube
from .raster import DepthBuffer, blended

FloatArray = npt.NDArray[np.float64]

FINE = 2  # pixels drawn for an edge of one that is kept: edges are smooth then


class Stage:
    """A figure with axes in 3D.

    Args:
        size: Edge of the picture [inch].
        dpi: Pixels per inch that are kept.
        cube: What is seen.
        azimuth: From where [deg].
        elevation: From where [deg].
    """

    def __init__(self, size: float, dpi: int, cube: Cube, azimuth: float, elevation: float) -> None:
        self.cube = cube
        self.figure = Figure(figsize=(size, size), dpi=FINE * dpi, facecolor="white")
        self._canvas = FigureCanvasAgg(self.figure)
        axes = self.figure.add_axes((0.0, 0.09, 1.0, 0.83), projection="3d", computed_zorder=False)
        assert isinstance(axes, Axes3D)
        self.axes = axes
        axes.set(
            **{
                f"{axis}lim": (c - cube.reach, c + cube.reach)
                for axis, c in zip("xyz", cube.center, strict=True)
            }
        )
        axes.set_box_aspect((1, 1, 1), zoom=1.09)
        axes.set_proj_type("persp", focal_length=1.6)
        axes.view_init(elev=elevation, azim=azimuth)
        axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
        for each in (axes.xaxis, axes.yaxis, axes.zaxis):
            each.set_pane_color((0.965, 0.97, 0.98, 1.0))
            each._axinfo["grid"].update(color="#d9dde3", linewidth=0.6)
        axes.tick_params(labelsize=8, colors="#555555", pad=1)
        _drawn(self._canvas)  # which places the axes
        self.width, self.height = self._canvas.get_width_height()

    def project(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Pixels from the upper left corner, (..., 2), and distance, (...,), of points (..., 3)."""
        lifted = np.concatenate([points, np.ones((*points.shape[:-1], 1))], axis=-1) @ self.axes.M.T
        flat = lifted[..., :2] / lifted[..., 3:]
        pixels = self.axes.transData.transform(flat.reshape(-1, 2)).reshape(flat.shape)
        pixels[..., 1] = self.height - pixels[..., 1]
        return pixels, lifted[..., 3]

    def buffer(self) -> DepthBuffer:
        """An empty one."""
        return DepthBuffer(self.width, self.height)

    def image(
        self, solid: DepthBuffer, layers: list[tuple[DepthBuffer, float]], over: Figure
    ) -> Image.Image:
        """What is on the axes, solids and layers before it, and a figure's artists over all."""
        whole = _picture(_drawn(self._canvas))
        color, opacity = blended(solid, layers)
        rgba = np.column_stack([color, opacity]).reshape(self.height, self.width, 4)
        whole.alpha_composite(_picture((255 * rgba + 0.5).astype(np.uint8)))
        whole.alpha_composite(_picture(_drawn(FigureCanvasAgg(over))))
        small = self.width // FINE, self.height // FINE
        return whole.convert("RGB").resize(small, Image.Resampling.BOX)


def _drawn(canvas: FigureCanvasAgg) -> npt.NDArray[np.uint8]:
    """The colours of its pixels, (H, W, 4)."""
    canvas.draw()  # type: ignore[no-untyped-call]
    return np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]


def _picture(rgba: npt.NDArray[np.uint8]) -> Image.Image:
    return Image.fromarray(np.ascontiguousarray(rgba), "RGBA")
