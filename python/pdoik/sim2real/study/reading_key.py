"""How a study says that logs are read, without its recordings."""

from __future__ import annotations

from pathlib import Path

from pdoik.errors import LoadError
from pdoik.recordings import Reading

from . import keys as study_keys


def reading_of_study(path: str | Path) -> Reading:
    """A study's `columns:`, `units:` and `ignore:`.

    Raises:
        LoadError: it is no study, or these keys are not as expected.
    """
    path = Path(path)
    if not path.is_file():
        raise LoadError(f"{path}: expected a study's YAML file with 'columns:'")
    content = study_keys.read_keys(path)
    study_keys.names(content.get("ignore"), "ignore")
    return Reading.of_content(content, path.name)
