"""Whether every number that decides what a diagnosis says stands in the table of thresholds.

python tests/deciding.py        prints the places where one does not, and fails if there are any

A number decides where something is compared with it: a literal, or a constant of a module. Zero, one and two are
no choices. What only says how finely or how long an algorithm works is no decision either: such a constant says so
in its comment, which begins with "numerics:".
"""

import ast
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent / "python" / "pdoik" / "sim2real"
TABLE = ROOT / "thresholds"
DRAWS = ROOT / "report"  # decides what is drawn, not what is said
NO_CHOICE = (0.0, 1.0, 2.0)
ORDERS = (ast.Lt, ast.Gt, ast.LtE, ast.GtE)


def main() -> None:
    """Print what decides outside of the table."""
    found = [each for path in sorted(ROOT.rglob("*.py")) for each in deciding(path)]
    for each in found:
        print(each)
    if found:
        sys.exit(f"{len(found)} numbers decide outside of {TABLE.name}")


def deciding(path: Path) -> Iterator[str]:
    """Comparisons of a file that a number outside of the table decides."""
    if TABLE in path.parents or DRAWS in path.parents:
        return
    text = path.read_text()
    tree, lines = ast.parse(text), text.splitlines()
    constants = set(constants_of(tree, lines))
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare) and any(isinstance(each, ORDERS) for each in node.ops):
            for side in (node.left, *node.comparators):
                for what in numbers_in(side, constants):
                    yield f"{path.relative_to(ROOT.parents[2])}:{node.lineno}: {what}"


def constants_of(tree: ast.Module, lines: list[str]) -> Iterator[str]:
    """Names of a module's numbers, less those of numerics."""
    for node in tree.body:
        if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
            continue
        target = node.targets[0] if isinstance(node, ast.Assign) else node.target
        said = " ".join(lines[max(node.lineno - 2, 0) : node.end_lineno])
        if isinstance(target, ast.Name) and is_number(node.value) and "numerics:" not in said:
            yield target.id


def is_number(node: ast.expr) -> bool:
    """Whether an expression is made of numbers alone."""
    return all(
        isinstance(each, ast.Constant | ast.BinOp | ast.UnaryOp | ast.operator | ast.unaryop)
        and not (isinstance(each, ast.Constant) and not isinstance(each.value, int | float))
        for each in ast.walk(node)
    )


def numbers_in(side: ast.expr, constants: set[str]) -> Iterator[str]:
    """Numbers by which a side of a comparison is scaled, or which it is."""
    for each in factors(side):
        if isinstance(each, ast.Name) and each.id in constants:
            yield each.id
        elif isinstance(each, ast.Constant) and isinstance(each.value, int | float):
            if not isinstance(each.value, bool) and abs(each.value) not in NO_CHOICE:
                yield str(each.value)


def factors(node: ast.expr) -> Iterator[ast.expr]:
    """Terms and factors of an expression, without what is inside of calls and indices."""
    if isinstance(node, ast.BinOp):
        yield from factors(node.left)
        yield from factors(node.right)
    elif isinstance(node, ast.UnaryOp):
        yield from factors(node.operand)
    else:
        yield node


if __name__ == "__main__":
    main()
