"""What the Python fuzzers kept or crashed on, once more: see tests/fuzz."""

import importlib.util
from collections.abc import Callable
from pathlib import Path

import pytest

FUZZ = Path(__file__).parents[2] / "fuzz"


def inputs(target: str) -> list[Path]:
    found = sorted((FUZZ / "corpus" / target).iterdir())
    assert found, f"tests/fuzz/corpus/{target} is empty"
    return found


def target(name: str) -> Callable[[bytes], None]:
    spec = importlib.util.spec_from_file_location(f"fuzz_{name}", FUZZ / f"fuzz_{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    check: Callable[[bytes], None] = module.check_one_input
    return check


@pytest.mark.parametrize("path", inputs("clouds"), ids=lambda path: path.name)
def test_any_bytes_are_a_cloud_or_a_load_error(path: Path) -> None:
    target("clouds")(path.read_bytes())


@pytest.mark.parametrize("path", inputs("border"), ids=lambda path: path.name)
def test_any_text_is_a_robot_hulls_pairs_or_an_error_of_ours(path: Path) -> None:
    target("border")(path.read_bytes())
