"""Fits that are kept by what they were fitted to, so that nothing is fitted twice."""

from __future__ import annotations

import hashlib
import json
import os
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from .. import _core
from .._cache import cache_folder, is_turned_off
from .._files import write_whole
from .capsules import Capsule
from .hulls import FloatArray, Shape
from .overhang import Overhang
from .pieces import Piece
from .surface_fit import Cover, Hull, SurfaceFit, Wanted


def folder_of_fits(given: str | os.PathLike[str] | bool | None) -> Path | None:
    """Where fits are kept; None for nowhere.

    Args:
        given: A folder; True for the user's (`cache_folder`), False for none, None for the user's
            unless the user has turned that off.
    """
    if given is None:
        given = not is_turned_off()
    if isinstance(given, bool):
        return cache_folder() / "hulls" if given else None
    return Path(given).expanduser()


def file_of(folder: Path, triangles: FloatArray, wanted: Wanted) -> Path:
    """The file of a fit, by every bit of the triangles, of the arguments and of the method."""
    digest = hashlib.sha256(_method())
    digest.update(repr(tuple(wanted)).encode())
    digest.update(np.ascontiguousarray(triangles, dtype="<f8").tobytes())
    return folder / f"{digest.hexdigest()[:32]}.json"


def read_fit(file: Path) -> SurfaceFit | None:
    """The fit that a file holds; None where there is none, or it is not as it was written."""
    try:
        digest, _, text = file.read_text("utf-8").partition("\n")
        if digest != _digest(text):
            return None
        return _read(json.loads(text))
    except (OSError, ValueError, TypeError, LookupError):
        return None


def write_fit(file: Path, fit: SurfaceFit) -> None:
    """Keep a fit; a folder that cannot be written to only costs the time again."""
    text = json.dumps(_listed(fit))
    with suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        write_whole(file, f"{_digest(text)}\n{text}")


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


@cache
def _method() -> bytes:
    """What stands for the version of the fit: its text, and the compiled module that it calls."""
    digest = hashlib.sha256(Path(_core.__file__).read_bytes())
    for file in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(file.read_bytes())
    return digest.digest()


def _listed(value: Any) -> Any:
    """Nested lists of what a fit is made of."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    return [_listed(each) for each in value] if isinstance(value, tuple) else value


def _read(rows: Any) -> SurfaceFit:
    covers, capsules, overhang, pieces = rows
    return SurfaceFit(
        covers=tuple(
            Cover(
                tuple(
                    Hull(Shape(np.array(a), np.array(b), semi_major), volume)
                    for (a, b, semi_major), volume in hulls
                ),
                volume,
            )
            for hulls, volume in covers
        ),
        capsules=tuple(
            Capsule(link, tuple(a), tuple(b), radius, out) for link, a, b, radius, out in capsules
        ),
        overhang=Overhang(*overhang),
        pieces=tuple(
            Piece(link, tuple(map(tuple, vertices)), tuple(map(tuple, triangles)), tolerance)
            for link, vertices, triangles, tolerance in pieces
        ),
    )
