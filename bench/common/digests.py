"""What a result depends on, as SHA-256: of files, and of facts."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pdoik
from bench.common.peer_library import ROOT

WORLDS = ROOT / "bench" / "sim2real"
TELLING = ("__main__.py", "report.py", "picture.py", "run.py")


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


def code_digest(*folders: str) -> str:
    """The diagnosis that is installed and what folders of bench/sim2real make, in twelve digits.

    The frame that they share counts with them. What only tells of results may change while a
    campaign goes on.
    """
    worlds = [WORLDS / folder for folder in ("frame", *folders)]
    files = [
        (f"{folder.name}/{path.relative_to(folder)}", path)
        for folder in (Path(pdoik.__file__).parent / "sim2real", *worlds)
        for path in folder.rglob("*.py")
        if folder not in worlds or not path.name.endswith(TELLING)
    ]
    return digest_of_files(files)[:12]


def core_digest() -> str:
    """Digest of the library's machine code: results of two builds are not to be mixed."""
    return hashlib.sha256(Path(pdoik._core.__file__).read_bytes()).hexdigest()[:16]
