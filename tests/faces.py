"""Says which imports reach past a package's face, and fails if there are any.

A package's face is its `__init__`. Its modules may import each other, and so may packages inside of
it; everybody else, tests and benches too, imports from the package what it exports. A line that has
to reach inside says why: `# inside: its steps are timed`.

    python tests/faces.py [FOLDER]     of the repository that this file is in, or of another
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

_ROOT = "pdoik"
_PROGRAMS = ("pdoik.cli", "pdoik.view")
"""What runs them is their face; their parts need extras, and are tested one by one."""


def modules_of(source: Path) -> tuple[dict[str, Path], set[str]]:
    """Files by their dotted name, and which of these names are packages."""
    files, packages = {}, set()
    for path in sorted((source / _ROOT).rglob("*.py")):
        parts = path.relative_to(source).with_suffix("").parts
        if parts[-1] == "__init__":
            parts = parts[:-1]
            packages.add(".".join(parts))
        files[".".join(parts)] = path
    return files, packages


def past_faces(source: Path, others: list[Path]) -> Iterator[str]:
    """A line for each import of a module of another package.

    Args:
        source: the folder that holds the package.
        others: folders of files that are in no package, such as tests.
    """
    files, packages = modules_of(source)
    outside = [path for folder in others for path in sorted(folder.rglob("*.py"))]
    for name, path in [*files.items(), *(("", path) for path in outside)]:
        mine = _package_of(name, packages) if name else ""
        for line, target in _imported(path, name, name in packages, files):
            theirs = _package_of(target, packages)
            inside = mine == theirs or mine.startswith(f"{theirs}.")
            program = theirs.startswith(_PROGRAMS)
            if target not in packages and theirs != _ROOT and not inside and not program:
                yield f"{path}:{line}: {target} is inside of {theirs}; import from the package"


def _package_of(module: str, packages: set[str]) -> str:
    while module not in packages:
        module = module.rpartition(".")[0]
    return module


def _imported(
    path: Path, name: str, is_package: bool, files: dict[str, Path]
) -> Iterator[tuple[int, str]]:
    """Modules that a file imports, or from which it imports names, with the line."""
    text = path.read_text(encoding="utf-8")
    lines = text.splitlines()
    for node in ast.walk(ast.parse(text)):
        if not isinstance(node, (ast.Import, ast.ImportFrom)) or any(
            "# inside: " in line for line in lines[node.lineno - 1 : node.end_lineno]
        ):
            continue
        if isinstance(node, ast.Import):
            yield from ((node.lineno, each.name) for each in node.names if each.name in files)
        else:
            target = node.module or ""
            if node.level:
                around = name.split(".") if is_package else name.split(".")[:-1]
                base = around[: len(around) - node.level + 1]
                target = ".".join([*base, *filter(None, [node.module])])
            if target in files:
                yield node.lineno, target
                exported = _exported(files[target])
                full = ((each.name, f"{target}.{each.name}") for each in node.names)
                yield from ((node.lineno, m) for n, m in full if m in files and n not in exported)


@cache
def _exported(path: Path) -> frozenset[str]:
    """Names that a module imports: those of a face."""
    nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
    imports = (node for node in nodes if isinstance(node, ast.ImportFrom))
    return frozenset(each.asname or each.name for node in imports for each in node.names)


def main() -> None:
    """Print them all; the status is 1 if there are any."""
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parents[1]
    found = list(past_faces(root / "python", [root / "tests", root / "bench"]))
    print(*found, f"{len(found)} imports reach past a face", sep="\n")
    sys.exit(bool(found))


if __name__ == "__main__":
    main()
