"""Folders of diagnoses named on the command line."""

from __future__ import annotations

import json
import re
from pathlib import Path

from pdoik.errors import LoadError

DIAGNOSIS = "diagnosis.json"
_FILES = (DIAGNOSIS, "model.json", "motions.npz", "report.html")


def report_folder(given: str) -> Path | None:
    """The folder of a diagnosis that an argument means, itself or by a file in it; None for others.

    A study means the folder `report` here or next to it, if that is of this study.

    Raises:
        LoadError: It is a folder without diagnosis, or a study without report.
    """
    path = Path(given).expanduser()
    if path.is_dir():
        if not (path / DIAGNOSIS).is_file():
            raise LoadError(
                f"{given} is a folder without {DIAGNOSIS}: expected a robot, or what"
                " pdoik diagnose STUDY --out FOLDER wrote"
            )
        return path
    if path.is_file() and path.name in _FILES:
        return path.parent
    if not _is_study(path):
        return None
    for folder in (Path("report"), path.parent / "report"):
        if _is_of(folder, path):
            return folder
    raise LoadError(
        f"{given} is a study, and it has no report yet: pdoik diagnose {given} --out report,"
        " then pdoik view report"
    )


def _is_study(path: Path) -> bool:
    if path.suffix not in (".yaml", ".yml") or not path.is_file():
        return False
    try:
        return re.search(r"^recordings:", path.read_text("utf-8"), re.MULTILINE) is not None
    except (OSError, UnicodeDecodeError):
        return False


def _is_of(folder: Path, study: Path) -> bool:
    try:
        source = json.loads((folder / "model.json").read_text("utf-8"))["study"]
        return Path(source).resolve() == study.resolve() and (folder / DIAGNOSIS).is_file()
    except (OSError, ValueError, KeyError, TypeError):
        return False
