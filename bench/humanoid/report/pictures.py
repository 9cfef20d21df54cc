"""Pictures and films of runs, drawn without a screen."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw, ImageFont

from bench.common.arrays import FloatArray
from bench.common.whole_files import write_whole
from bench.humanoid.world.model import World
from bench.humanoid.world.simulate import Run, replay

Picture = npt.NDArray[np.uint8]  # (height, width, 3)

LOOK_AT = (0.0, -0.1, 0.78)  # world [m]
AZIMUTH, ELEVATION, RANGE = 112.0, -12.0, 2.7  # of the camera, [deg], [deg], [m]
SLOW = 2.0  # how many times slower films are than what happened
STRIP, FILM, GIF = (420, 620), (640, 480), (360, 400)  # width, height [px]
COLORS = 64  # of a GIF


def strip(world: World, run: Run, n: int = 6) -> Picture:
    """Key frames from 1 s before the least distance to 0.3 s after it, with their times."""
    nearest = float(run.distance_time[np.argmin(run.distance)])
    begin, end = max(0.0, nearest - 1.0), min(float(run.time[-1]), nearest + 0.3)
    pictures = _frames(world, run, np.linspace(begin, end, n), STRIP)
    gap = np.full((STRIP[1], 4, 3), 255, dtype=np.uint8)
    return np.hstack([part for picture in pictures for part in (picture, gap)][:-1])


def write_film(world: World, run: Run, path: Path) -> None:
    """The run as an MP4; needs imageio and imageio-ffmpeg."""
    import imageio.v2 as imageio

    rate = 30.0
    times = np.arange(0.0, float(run.time[-1]), 1.0 / (rate * SLOW))
    pictures = _frames(world, run, times, FILM)

    def write(file: Path) -> None:
        with imageio.get_writer(file, fps=rate, codec="libx264", quality=8) as film:
            for picture in pictures:
                film.append_data(picture)

    write_whole(path, write)


def write_gif(world: World, run: Run, path: Path) -> None:
    """The run from 1.6 s before the least distance to 1.4 s on, as an animated picture."""
    rate = 12.0
    nearest = float(run.distance_time[np.argmin(run.distance)])
    begin, end = max(0.0, nearest - 1.6), min(float(run.time[-1]), nearest + 1.4)
    times = np.arange(begin, end, 1.0 / (rate * SLOW))
    large = _frames(world, run, times, (2 * GIF[0], 2 * GIF[1]))  # halved: smooth edges
    images = [Image.fromarray(picture).resize(GIF) for picture in large]
    # One palette for all, so that what stands still stays the same to the byte. The object is
    # small: without swatches of its own it would be grey.
    parts = [np.asarray(image) for image in images[:: max(1, len(images) // 4)]]
    palette = Image.fromarray(np.hstack([*parts, _swatches(world, GIF[1])])).quantize(COLORS)
    flat = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    duration = round(1000 / rate / 10) * 10  # GIF counts in hundredths of a second
    more: dict[str, Any] = {"append_images": flat[1:], "duration": duration, "loop": 0}
    write_whole(path, lambda file: flat[0].save(file, save_all=True, optimize=False, **more))


def _frames(world: World, run: Run, times: FloatArray, size: tuple[int, int]) -> list[Picture]:
    """Pictures of a run at some times [s], which stand in their corners."""
    view = mujoco.MjvCamera()
    view.lookat[:] = LOOK_AT
    view.azimuth, view.elevation, view.distance = AZIMUTH, ELEVATION, RANGE
    option = mujoco.MjvOption()
    option.geomgroup[:] = [1, 1, 1, 0, 0, 0]
    pictures = []
    with closing(mujoco.Renderer(world.model, height=size[1], width=size[0])) as renderer:
        for k in np.searchsorted(run.time, times - 1e-9):
            renderer.update_scene(replay(world, run, k), view, option)
            pictures.append(_labelled(renderer.render(), f"t = {run.time[k]:.2f} s"))
    return pictures


def _labelled(picture: Picture, text: str) -> Picture:
    image = Image.fromarray(picture)
    font = ImageFont.load_default(size=max(14, picture.shape[0] // 24))
    ImageDraw.Draw(image).text((12, 8), text, fill=(20, 20, 20), font=font)
    return np.array(image, dtype=np.uint8)


def _swatches(world: World, height: int, n: int = 8) -> Picture:
    """The object's colour, light and dark, (height, 40 n, 3)."""
    color = world.model.geom_rgba[world.object_geoms[0], :3]
    shades = 255 * np.clip(np.linspace(0.3, 1.3, n)[:, None] * color, 0, 1)
    return np.tile(np.repeat(shades.astype(np.uint8), 40, axis=0), (height, 1, 1))
