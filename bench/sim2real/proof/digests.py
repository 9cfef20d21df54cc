"""What the proof depends on: the worlds, and what scores them."""

from __future__ import annotations

from pathlib import Path

from bench.common.digests import digest_of_files, digest_of_folder

HERE = Path(__file__).parent
OTHERS = ("peers_", "beyond_")  # other experiments of this folder, which decide no score here


def generator_digest() -> str:
    """The worlds."""
    return digest_of_folder(HERE.parent / "concealed", "*.py")


def scoring_digest() -> str:
    """What turns truths and diagnoses into scores and tables."""
    files = [(path.name, path) for path in HERE.glob("*.py") if not path.name.startswith(OTHERS)]
    score = HERE.parent / "diagnosis" / "score.py"
    return digest_of_files([*files, ("../diagnosis/score.py", score)])
