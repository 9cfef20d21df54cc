"""xacro, by the package of that name."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from .._extras import asks_for
from ..errors import LoadError
from .packages import package_folder


def expanded(
    path: Path, arguments: Mapping[str, str], packages: Mapping[str, str | os.PathLike[str]]
) -> str:
    """The URDF that a xacro file stands for.

    Raises:
        LoadError: xacro refuses the file.
        MissingExtraError: xacro is not installed.
    """
    with asks_for("files"):
        import xacro
        from xacro import substitution_args

    def find(name: str) -> str:
        folder = package_folder(name, path, packages)
        if folder is None:
            raise LoadError(
                f"{path}: package {name!r} is nowhere: tell its folder, packages={{{name!r}: ...}},"
                " or the folder above it in PDOIK_PACKAGE_PATH"
            )
        return str(folder)

    before = substitution_args._eval_find
    substitution_args._eval_find = find
    try:
        return str(xacro.process_file(str(path), mappings=dict(arguments)).toxml())
    except LoadError:
        raise
    except Exception as error:  # whatever its expressions meet
        raise LoadError(f"{path}: xacro: {error}") from error
    finally:
        substitution_args._eval_find = before
