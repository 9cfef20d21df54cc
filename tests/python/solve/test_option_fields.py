"""An option is typed once, in its header: its name, range and text are written from there."""

from __future__ import annotations

import dataclasses
import importlib.util
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import pdoik

ROOT = Path(__file__).parents[3]
GENERATOR = ROOT / "python" / "bindings" / "option_fields.py"


@pytest.fixture(scope="module")
def panda() -> pdoik.Robot:
    return pdoik.Robot.builtin("panda")


@pytest.fixture
def generator(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The generator, of a copy of the headers."""
    spec = importlib.util.spec_from_file_location("option_fields", GENERATOR)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "option_fields", module)
    spec.loader.exec_module(module)
    shutil.copytree(module.HEADERS, tmp_path / "headers")
    monkeypatch.setattr(module, "HEADERS", tmp_path / "headers")
    return module


def add_option(generator: ModuleType, declaration: str) -> None:
    """Declare an option after TouchOptions::depth."""
    header = generator.HEADERS / "options.hpp"
    before, found, after = header.read_text().partition("  /// Which links may touch them;")
    assert found
    header.write_text(before + declaration + found + after)


def numbers(options: object, *place: str) -> Iterator[tuple[str, ...]]:
    """Where dataclasses of options have numbers."""
    for field in dataclasses.fields(options):
        value = getattr(options, field.name)
        if dataclasses.is_dataclass(value):
            yield from numbers(value, *place, field.name)
        elif type(value) in (int, float):
            yield (*place, field.name)


def with_number(options: object, place: tuple[str, ...], number: float) -> object:
    """The same options with one number changed."""
    name, *inner = place
    value = with_number(getattr(options, name), tuple(inner), number) if inner else number
    return dataclasses.replace(options, **{name: value})


@pytest.mark.parametrize("place", list(numbers(pdoik.Options())), ids=".".join)
def test_every_number_is_refused_by_its_name(panda: pdoik.Robot, place: tuple[str, ...]) -> None:
    default = pdoik.Options()
    for name in place:
        default = getattr(default, name)
    if place == ("seed",):
        with pytest.raises(TypeError, match=r"Options\.seed is -1, expected int"):
            with_number(pdoik.Options(), place, -1)
        return
    options = with_number(pdoik.Options(), place, -1 if isinstance(default, int) else np.nan)
    name = r"\.".join(place)
    with pytest.raises(ValueError, match=rf"^{name} is (-1|nan), expected .*[a-z0-9\])]$"):
        pdoik.Solver(panda, options)


def test_every_option_and_its_range_are_in_the_docstring() -> None:
    for kind in (pdoik.Options, pdoik.Touch, pdoik.Balance, pdoik.LbfgsOptions):
        for field in dataclasses.fields(kind):
            assert f"\n        {field.name}: " in kind.__doc__
    assert "position_tolerance: Largest position error of a success, in (0, inf) [m].\n" in (
        pdoik.Options.__doc__
    )
    assert "curvature: c2 of the Wolfe conditions, in (armijo, 1).\n" in pdoik.LbfgsOptions.__doc__
    assert 'for goal "axis"' in pdoik.Options.__doc__
    assert "::" not in pdoik.Options.__doc__


def test_what_is_written_is_what_the_headers_say() -> None:
    pytest.importorskip("ruff")
    pytest.importorskip("clang_format")
    done = subprocess.run(
        [sys.executable, GENERATOR, "--check"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_a_new_option_is_one_edit_of_its_header(generator: ModuleType) -> None:
    add_option(
        generator,
        "  /// How far a touch may slide, for GoalType::Axis;\n"
        "  /// std::nullopt is not for it, in (radius, 2.5] [m].\n"
        "  double slip = 0.5;\n"
        "  int tries = 3;  ///< how often it is tried, in [1, inf)\n",
    )
    declared = generator.read()
    python = generator.to_python(declared)
    assert (
        'slip: How far a touch may slide, for goal "axis"; None is not for it, in (radius, 2.5] [m]'
        in python
    )
    assert "    slip: float = DEFAULT.touch.slip\n    tries: int = DEFAULT.touch.tries\n" in python
    cpp = generator.to_cpp(declared)
    assert (
        'Field{"slip", &TouchOptions::slip, [](const TouchOptions& o) '
        '{ return o.slip > o.radius && o.slip <= 2.5; }, "a number in (radius, 2.5] [m]"}'
    ) in cpp
    assert "{ return o.tries >= 1; }" in cpp


@pytest.mark.parametrize(
    ("declaration", "message"),
    [
        ("double slip = 0.5;  ///< how far it may slide [m]", "its comment ends with no range"),
        ("std::string slip = {};  ///< how it slides", "TYPES has no std::string"),
        ("std::array<double, 2> slip = {};  ///< how it slides", "its type is not understood"),
    ],
)
def test_what_cannot_be_written_is_refused_by_name(
    generator: ModuleType, declaration: str, message: str
) -> None:
    add_option(generator, f"  {declaration}\n")
    with pytest.raises(SystemExit, match=f"TouchOptions::slip: {message}"):
        generator.read()


@pytest.mark.parametrize(
    ("ends", "holds", "words"),
    [
        ("(0, inf)", "o.x > 0.0 && std::isfinite(o.x)", "a positive finite number"),
        ("(0, inf]", "o.x > 0.0", "a positive number"),
        ("[0, inf)", "o.x >= 0.0 && std::isfinite(o.x)", "a finite number of at least 0"),
        ("[0, inf]", "o.x >= 0.0", "at least 0"),
        ("(1, inf)", "o.x > 1.0 && std::isfinite(o.x)", "a finite number above 1"),
        ("(-inf, inf)", "std::isfinite(o.x)", "a finite number"),
        ("[-1, 1]", "o.x >= -1.0 && o.x <= 1.0", "-1 to 1"),
        ("(0, 1]", "o.x > 0.0 && o.x <= 1.0", "a number in (0, 1]"),
        ("[low, inf]", "o.x >= o.low", "at least low"),
    ],
)
def test_ranges_are_conditions_and_words(
    generator: ModuleType, ends: str, holds: str, words: str
) -> None:
    range_ = generator.Range.of("x", "double", f"what it is, in {ends}")
    assert (range_.holds("x"), range_.words()) == (holds, words)
