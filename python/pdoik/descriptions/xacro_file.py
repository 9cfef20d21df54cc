"""xacro, by the package of that name."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from .._addresses import Places
from .._extras import asks_for
from ..errors import LoadError


def expanded(path: Path, arguments: Mapping[str, str], places: Places) -> str:
    """The URDF that a xacro file stands for.

    Raises:
        LoadError: xacro refuses the file.
        MissingExtraError: xacro is not installed.
    """
    with asks_for("files"):
        import xacro
        from xacro import substitution_args

    missing: list[LoadError] = []

    def find(name: str) -> str:
        try:
            return str(places.package(name))
        except LoadError as error:
            missing.append(error)
            raise

    before = substitution_args._eval_find
    substitution_args._eval_find = find
    try:
        return str(
            xacro.process_file(
                str(path), mappings={k: str(v) for k, v in arguments.items()}
            ).toxml()
        )
    except Exception as error:  # whatever its expressions meet
        said = missing[0] if missing else f"xacro: {error}"  # xacro makes one of its own of any
        raise LoadError(f"{path}: {said}") from error
    finally:
        substitution_args._eval_find = before
