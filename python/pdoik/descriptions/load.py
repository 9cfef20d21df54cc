"""One call from a file or a name to a robot."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from .._core import Occupancy, Robot, load_srdf_pairs
from .._files import write_whole
from .text import Given, cache, urdf_of


def load_robot(
    robot: str | os.PathLike[str],
    base_link: str | None = None,
    tip_link: str | Sequence[str] | None = None,
    *,
    srdf: str | os.PathLike[str] | None = None,
    hulls: bool = False,
    arguments: Mapping[str, str] | None = None,
    packages: Mapping[str, str | os.PathLike[str]] | None = None,
) -> Robot:
    """A robot from a URDF, xacro or MJCF file, or by name.

    Args:
        robot: A shipped robot ("panda"), a file, or an installed description ("ur5_robot"): see
            `urdf_text`. A shipped one goes first, and has its hulls.
        base_link: First link of the chain; None for the root.
        tip_link: Its end, or several; None for the only leaf.
        srdf: Pairs of links that may touch.
        hulls: Fit hulls to its collision geometry, which takes a minute or two for an arm. They are
            kept in the user's cache (XDG_CACHE_HOME), and taken from there the next time.
        arguments: Of a xacro file.
        packages: Folders of packages, by name.

    Raises:
        LoadError: It is not there or cannot be read.
    """
    if str(robot) in Robot.builtin_names():
        loaded = Robot.builtin(str(robot), base_link=base_link, tip_link=tip_link)
    else:
        with TemporaryDirectory(prefix="pdoik-meshes-") as folder:
            meshes = Path(folder) if hulls else None
            given = Given.of(robot)
            text = urdf_of(given, arguments or {}, packages or {}, meshes)
            source = given.path if given.kind == "urdf" else text  # messages name a file
            loaded = Robot.from_urdf(source, base_link=base_link, tip_link=tip_link)
            if hulls:
                loaded.occupancy = _hulls(text, given.path.resolve().parent, folder)
    if srdf is not None:
        loaded.ignored_pairs = load_srdf_pairs(srdf, loaded)
    return loaded


def _hulls(text: str, beside: Path, meshes: str) -> Occupancy:
    """Of the geometry, from the cache if it was fitted before."""
    from ..occupancy_fit import fit_occupancy
    from ..occupancy_fit.geometry import load_geometry

    links = load_geometry(text, [beside])
    digest = hashlib.sha256(text.replace(meshes, "").encode())
    for link in links:
        digest.update(link.triangles.tobytes())
    kept = cache() / "hulls" / f"{digest.hexdigest()[:24]}.occupancy.yaml"
    if not kept.is_file():
        fitted = fit_occupancy(text, [beside])
        kept.parent.mkdir(parents=True, exist_ok=True)
        write_whole(kept, fitted.to_yaml())
    return Occupancy.load(str(kept))
