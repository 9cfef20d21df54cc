"""What a result depends on, as SHA-256: of files, and of facts."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pdoik

OTHERS = ("peers_", "beyond_")  # other experiments of this folder, which decide no score here


def digest_of_files(files: Iterable[tuple[str, Path]]) -> str:
    """Over names and bytes, in the order of the names."""
    digest = hashlib.sha256()
    for name, path in sorted(files):
        digest.update(f"{name}\0{path.stat().st_size}\0".encode())
        with path.open("rb") as file:
            while chunk := file.read(1 << 20):
                digest.update(chunk)
    return digest.hexdigest()


def digest_of_folder(folder: Path, pattern: str = "*") -> str:
    """Over all files below a folder, by their paths in it; caches left out."""
    files = [path for path in folder.rglob(pattern) if path.is_file()]
    kept = [path for path in files if "__pycache__" not in path.parts]
    return digest_of_files((path.relative_to(folder).as_posix(), path) for path in kept)


def digest_of(facts: Any) -> str:
    """Over facts that JSON can hold."""
    text = json.dumps(facts, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def tool_digest() -> str:
    """The diagnosis that is installed, its catalogue and thresholds with it."""
    return digest_of_folder(Path(pdoik.__file__).parent / "sim2real")


def generator_digest() -> str:
    """The worlds."""
    return digest_of_folder(Path(__file__).parents[1] / "concealed", "*.py")


def scoring_digest() -> str:
    """What turns truths and diagnoses into scores and tables."""
    here = Path(__file__).parent
    files = [(path.name, path) for path in here.glob("*.py") if not path.name.startswith(OTHERS)]
    return digest_of_files([*files, ("../diagnosis_score.py", here.parent / "diagnosis_score.py")])
