"""Keeps in tests/fuzz/corpus the inputs by which a fuzzer's coverage grew the most.

    .venv/bin/python tests/fuzz/keep.py TARGET [COUNT]     after bash tests/fuzz.sh

libFuzzer's merge takes the inputs of build/fuzz/corpus/TARGET smallest first and says what each
adds; the COUNT (12) that add the most edges replace those that were kept so before. Inputs with
names of their own (seeds, and what once crashed) stay.
"""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
LARGEST = 2000  # bytes of an input that is kept


def edges_added(target: str, inputs: Path) -> dict[Path, int]:
    """How many edges each input covers that no smaller one does."""
    fuzzer = ROOT / "build/fuzz/cmake/tests/fuzz" / f"pdoik_fuzz_{target}"
    program, said = [str(fuzzer)], "COV"
    if not fuzzer.exists():  # Atheris speaks of features alone
        program, said = [sys.executable, str(ROOT / "tests/fuzz" / f"fuzz_{target}.py")], "FT"
    files = sorted(inputs.iterdir(), key=lambda path: path.stat().st_size)
    with tempfile.TemporaryDirectory() as folder:
        # The inner half of -merge=1: it reads a list of files and writes down what each one adds.
        control = Path(folder, "control")
        control.write_text("\n".join([str(len(files)), "0", *map(str, files)]) + "\n")
        flags = ["-merge_inner=1", f"-merge_control_file={control}", "-detect_leaks=0"]
        subprocess.run([*program, *flags], check=True, capture_output=True)
        lines = control.read_text().splitlines()[2 + len(files) :]
    words = [line.split() for line in lines]
    return {files[int(line[1])]: len(line) - 2 for line in words if line[0] == said}


def main() -> None:
    target, most = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 12
    kept = ROOT / "tests/fuzz/corpus" / target
    added = edges_added(target, ROOT / "build/fuzz/corpus" / target)
    small = [path for path in added if path.stat().st_size <= LARGEST and added[path] > 0]
    best = sorted(small, key=lambda path: -added[path])[:most]
    for old in kept.glob("found_*"):
        old.unlink()
    for k, path in enumerate(best):
        shutil.copy(path, kept / f"found_{k:02d}")
    covered = sum(edges_added(target, kept).values())
    print(f"{target}: {covered} of {sum(added.values())} edges (Python: features)")


if __name__ == "__main__":
    main()
