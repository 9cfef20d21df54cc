"""Pictures and films of runs, drawn without a screen."""

from __future__ import annotations

import io
import os
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

os.environ.setdefault("MUJOCO_GL", "egl")  # before mujoco is imported

import mujoco
import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw, ImageFont

from pdoik._files import renamed_when_whole, write_whole
from pdoik.h1.model import World
from pdoik.h1.simulate import Run, replay

Picture = npt.NDArray[np.uint8]  # (height, width, 3)

LOOK_AT = (0.0, -0.1, 0.78)  # world [m]
AZIMUTH, ELEVATION, RANGE = 112.0, -12.0, 2.7  # of the camera, [deg], [deg], [m]


def camera(
    azimuth: float = AZIMUTH, elevation: float = ELEVATION, distance: float = RANGE
) -> mujoco.MjvCamera:
    """A camera on the robot; azimuth 90 looks along +y, at its front [deg], [deg], [m]."""
    view = mujoco.MjvCamera()
    view.lookat[:] = LOOK_AT
    view.azimuth, view.elevation, view.distance = azimuth, elevation, distance
    return view


def frames(
    world: World,
    run: Run,
    steps: Sequence[int],
    size: tuple[int, int] = (640, 720),
    view: mujoco.MjvCamera | None = None,
) -> list[Picture]:
    """Pictures of a run at some of its steps; size is width, height [px]."""
    view = view if view is not None else camera()
    option = mujoco.MjvOption()
    option.geomgroup[:] = [1, 1, 1, 0, 0, 0]
    pictures = []
    with closing(mujoco.Renderer(world.model, height=size[1], width=size[0])) as renderer:
        for k in steps:
            renderer.update_scene(replay(world, run, k), view, option)
            pictures.append(np.array(renderer.render(), dtype=np.uint8))
    return pictures


def key_steps(run: Run, n: int = 6, before: float = 1.0, after: float = 0.3) -> list[int]:
    """Steps about the instant of least distance, evenly from `before` to `after` it [s]."""
    nearest = float(run.distance_time[np.argmin(run.distance)])
    begin, end = max(0.0, nearest - before), min(float(run.time[-1]), nearest + after)
    return [int(np.searchsorted(run.time, t)) for t in np.linspace(begin, end, n) - 1e-9]


def strip(
    world: World,
    run: Run,
    steps: Sequence[int] | None = None,
    size: tuple[int, int] = (420, 620),
    view: mujoco.MjvCamera | None = None,
    n: int = 6,
) -> Picture:
    """Key frames side by side, with their times: at `steps`, else n about the nearest instant."""
    steps = key_steps(run, n) if steps is None else steps
    pictures = frames(world, run, steps, size, view)
    labelled = [
        _labelled(picture, f"t = {run.time[k]:.2f} s")
        for picture, k in zip(pictures, steps, strict=True)
    ]
    gap = np.full((size[1], 4, 3), 255, dtype=np.uint8)
    return np.hstack([part for picture in labelled for part in (picture, gap)][:-1])


def write_film(
    world: World,
    run: Run,
    path: str | Path,
    *,
    frame_rate: float = 30.0,
    slow: float = 2.0,
    size: tuple[int, int] = (640, 480),
    view: mujoco.MjvCamera | None = None,
) -> None:
    """The run as an MP4, `slow` times slower than it was; needs imageio and imageio-ffmpeg."""
    import imageio.v2 as imageio

    times = np.arange(0.0, float(run.time[-1]), 1.0 / (frame_rate * slow))
    steps = [int(np.searchsorted(run.time, t)) for t in times]
    writer: Any = imageio.get_writer  # its stubs know of no frames
    with (
        renamed_when_whole(path) as temporary,
        writer(temporary, fps=frame_rate, codec="libx264", quality=8) as film,
    ):
        for k, picture in zip(steps, frames(world, run, steps, size, view), strict=True):
            film.append_data(_labelled(picture, f"t = {run.time[k]:.2f} s"))


def write_gif(
    world: World,
    run: Run,
    path: str | Path,
    *,
    before: float = 1.6,
    after: float = 1.4,
    frame_rate: float = 12.0,
    slow: float = 2.0,
    size: tuple[int, int] = (360, 400),
    colors: int = 64,
    view: mujoco.MjvCamera | None = None,
) -> None:
    """The run about the least distance [s] as an animated picture; the file appears whole."""
    nearest = float(run.distance_time[np.argmin(run.distance)])
    begin, end = max(0.0, nearest - before), min(float(run.time[-1]), nearest + after)
    times = np.arange(begin, end, 1.0 / (frame_rate * slow))
    steps = [int(np.searchsorted(run.time, t - 1e-9)) for t in times]
    large = frames(world, run, steps, (2 * size[0], 2 * size[1]), view)  # halved: smooth edges
    images = [
        Image.fromarray(_labelled(picture, f"t = {run.time[k]:.2f} s")).resize(size)
        for k, picture in zip(steps, large, strict=True)
    ]
    # One palette for all, so that what stands still stays the same to the byte. The object is
    # small: without swatches of its own it would be grey.
    parts = [np.asarray(image) for image in images[:: max(1, len(images) // 4)]]
    palette = Image.fromarray(np.hstack([*parts, _swatches(world, size[1])])).quantize(colors)
    flat = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    buffer = io.BytesIO()
    duration = round(1000 / frame_rate / 10) * 10  # GIF counts in hundredths of a second
    flat[0].save(
        buffer,
        "GIF",
        save_all=True,
        append_images=flat[1:],
        duration=duration,
        loop=0,
        optimize=False,
    )
    write_whole(path, buffer.getvalue())


def _swatches(world: World, height: int, n: int = 8) -> Picture:
    """The object's colour, light and dark, (height, 40 n, 3)."""
    geoms = list(world.object_geoms)
    color = world.model.geom_rgba[geoms[0], :3] if geoms else np.zeros(3)
    shades = 255 * np.clip(np.linspace(0.3, 1.3, n)[:, None] * color, 0, 1)
    return np.tile(np.repeat(shades.astype(np.uint8), 40, axis=0), (height, 1, 1))


def save_picture(picture: Picture, path: str | Path) -> None:
    """Write a PNG."""
    Image.fromarray(picture).save(path)


def _labelled(picture: Picture, text: str) -> Picture:
    image = Image.fromarray(picture)
    draw: Any = ImageDraw.Draw(image)
    font = ImageFont.load_default(size=max(14, picture.shape[0] // 24))
    draw.text((12, 8), text, fill=(20, 20, 20), font=font)
    return np.array(image, dtype=np.uint8)
