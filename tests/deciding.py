"""Whether every number that decides what a diagnosis says stands in the table of thresholds.

python tests/deciding.py        prints the places where one does not, and fails if there are any

A number decides where something is compared with it: a literal, or a constant of a module. Zero
and one are no choices, nor are the few rows that a fit needs, rounding, and what is as good as
endless. What only says how finely or how long an algorithm works decides nothing either: such a
constant says so in its comment, which begins with "numerics:". What an effect needs of its data is
part of the effect, in its class.
"""

import ast
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent / "python" / "pdoik" / "sim2real"
TABLE = ROOT / "thresholds"
OTHERS = (ROOT / "report", ROOT / "effect_check")  # what is drawn, and tests of effects
NO_CHOICE = (0.0, 1.0, 2.0)
FEW, ROUNDING, ENDLESS = 10, 1e-6, 1e6
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
    if any(room in path.parents for room in (TABLE, *OTHERS)):
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
        if not isinstance(target, ast.Name) or not is_number(node.value) or "numerics:" in said:
            continue
        if not (isinstance(node.value, ast.Constant) and is_no_choice(node.value.value)):
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
            yield from () if is_no_choice(each.value) else (str(each.value),)


def is_no_choice(value: float) -> bool:
    """Whether a number is a bound by its nature."""
    size = abs(value)
    few = isinstance(value, int) and size < FEW
    return isinstance(value, bool) or few or size in NO_CHOICE or not ROUNDING < size < ENDLESS


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
