"""A picture of where the capsules that hold a robot's links stick out most, link by link."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt
from matplotlib.colors import to_rgb
from PIL import Image

from pdoik._files import write_whole
from pdoik.occupancy_fit import Capsule, Capsules, Solid, worst_place

from .cube import Cube
from .facets import FacetSoup
from .labels import Labels
from .raster import covered
from .stage import FINE, Stage
from .style import FAILS, HULL, SHAPE
from .view import camera

FloatArray = npt.NDArray[np.float64]

_COLUMNS = 3
_SIZE, _DPI = 4.2, 100  # of a link's picture [inch], [1/inch]
_GLASS = 0.4  # opacity of capsules
_ROOM = 1.02  # around a link and its capsules, as a factor
_ELEVATION = 20.0  # [deg]


def draw_overhangs(
    path: str | Path, capsules: Sequence[Capsule], meshes: Mapping[str, npt.ArrayLike]
) -> None:
    """Draw each link, its capsules as glass, and the place where they stick out most.

    Args:
        path: A PNG file; an old one is replaced once the new one is whole.
        capsules: Of all links.
        meshes: Per link its triangles, (T, 3, 3) [m]; links without capsules are left out.
    """
    pictures = []
    for link, triangles in meshes.items():
        own = [capsule for capsule in capsules if capsule.link == link]
        if own:
            a, b, radius = (np.array([hull[k] for hull in own]) for k in (1, 2, 3))
            pictures.append(_picture(link, np.asarray(triangles), Capsules(a, b, radius)))
    if not pictures:
        raise ValueError("none of the links has capsules")
    width, height = pictures[0].size
    columns = min(_COLUMNS, len(pictures))
    whole = Image.new("RGB", (columns * width, -(-len(pictures) // columns) * height), "white")
    for k, picture in enumerate(pictures):
        whole.paste(picture, (k % columns * width, k // columns * height))
    buffer = io.BytesIO()
    whole.save(buffer, format="png")
    write_whole(path, buffer.getvalue())


def _picture(link: str, triangles: FloatArray, capsules: Capsules) -> Image.Image:
    place, foot = worst_place(Solid.of(triangles), capsules)
    reach = capsules.radius[:, None]
    ends = [capsules.a - reach, capsules.a + reach, capsules.b - reach, capsules.b + reach]
    low, high = np.min(ends, axis=(0, 1)), np.max(ends, axis=(0, 1))
    cube = Cube((low + high) / 2, _ROOM * float((high - low).max()) / 2)
    azimuth = _from_the_side(place - foot, place - cube.center)
    stage = Stage(_SIZE, _DPI, cube, azimuth, _ELEVATION)
    eye = cube.center + 6 * cube.reach * camera(azimuth, _ELEVATION)[0]
    mesh, glass = FacetSoup(), FacetSoup()
    mesh.add(triangles, np.array(to_rgb(SHAPE)))
    for a, b, radius in zip(*capsules, strict=True):
        glass.capsule(a, b, radius, HULL)
    solid, layer = stage.buffer(), stage.buffer()
    solid.fill(stage.project, mesh.corners, mesh.lit(eye))
    layer.fill(stage.project, glass.corners, glass.lit(eye))
    labels = Labels(stage.width, stage.height, FINE * _DPI, covered([solid, layer]))
    line = stage.project(np.stack([place, foot]))[0]
    labels.line(line, FAILS, 2.0)
    labels.dots(line[:1], FAILS, 5.0)
    out = 1e3 * float(np.linalg.norm(place - foot))
    labels.note(line[0], f"{out:.1f} mm", FAILS, 9.0)
    stage.figure.text(0.02, 0.96, link, fontsize=11, fontweight="bold", va="top")
    stage.figure.text(
        0.02, 0.915, f"{len(capsules.radius)} capsules", fontsize=9, va="top", color="#555555"
    )
    return stage.image(solid, [(layer, _GLASS)], labels.figure)


def _from_the_side(out: FloatArray, outwards: FloatArray) -> float:
    """The azimuth [deg] that shows a line at its full length, and its side of the link in front."""

    def merit(azimuth: float) -> float:
        toward, right, up = camera(azimuth, _ELEVATION)
        seen = np.hypot(out @ right, out @ up) / max(float(np.linalg.norm(out)), 1e-12)
        front = outwards @ toward / max(float(np.linalg.norm(outwards)), 1e-12)
        return float(seen + 0.5 * front)

    return max([float(azimuth) for azimuth in range(-175, 180, 10)], key=merit)
