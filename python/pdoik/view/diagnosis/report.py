"""The folder of a diagnosis, as `pdoik diagnose` writes it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pdoik.errors import LoadError
from pdoik.sim2real import Diagnosis
from pdoik.sim2real.evidence import FILE_NAME, Motions
from pdoik.sim2real.model import Model

DIAGNOSIS = "diagnosis.json"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Report:
    """What was found, of which machine, and how it moved."""

    folder: Path
    diagnosis: Diagnosis
    model: Model
    motions: Motions


def load_report(folder: Path) -> Report:
    """Read diagnosis.json, model.json and motions.npz.

    Raises:
        LoadError: One of them is missing or is not what it should be.
    """
    file = folder / DIAGNOSIS
    try:
        diagnosis = Diagnosis.from_json(file.read_text(encoding="utf-8"))
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise LoadError(f"{file}: cannot be read: {error}") from None
    model = Model.load(folder)
    if not (folder / FILE_NAME).is_file():
        study = model.study or "STUDY.yaml"
        raise LoadError(
            f"{folder}: no {FILE_NAME}, which earlier versions did not write:"
            f" pdoik diagnose {study} --out {folder}"
        )
    return Report(
        folder=folder, diagnosis=diagnosis, model=model, motions=Motions.load(folder / FILE_NAME)
    )
