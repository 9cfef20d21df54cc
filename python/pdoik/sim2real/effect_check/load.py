"""Effects of a file that somebody wrote, or of the catalogue by their id."""

from __future__ import annotations

import importlib.util
import inspect
import sys
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

from pdoik._nearest import nearest
from pdoik.errors import LoadError

from ..effects import CATALOGUE, Effect


def load_effects(file_or_id: str) -> tuple[Effect, ...]:
    """The effect of an id, or all of a Python file: registered, instances and classes.

    What the file registers is in the catalogue only while it is loaded: see `tried`.

    Raises:
        LoadError: there is no such file or id, the file does not load, or holds no effect.
    """
    if file_or_id in CATALOGUE:
        return (CATALOGUE[file_or_id],)
    path = Path(file_or_id)
    if path.suffix != ".py":
        raise LoadError(
            f"no effect {file_or_id!r}{nearest(file_or_id, CATALOGUE)}; a file's name ends in .py"
        )
    if not path.is_file():
        raise LoadError(f"{path}: there is no such file")
    before = dict(CATALOGUE)
    try:
        module = _loaded(path)
        new = [each for name, each in CATALOGUE.items() if before.get(name) is not each]
    finally:
        CATALOGUE.clear()
        CATALOGUE.update(before)
    found = {id(type(each)): each for each in new}
    for each in vars(module).values():
        if isinstance(each, Effect) and type(each).__module__ == module.__name__:
            found.setdefault(id(type(each)), each)
    for each in vars(module).values():
        if _is_own_class(each, module) and id(each) not in found:
            found[id(each)] = _made(path, each)
    unfinished = [each for each in vars(module).values() if _is_unfinished(each, module)]
    if not found and unfinished:
        lacking = ", ".join(sorted(unfinished[0].__abstractmethods__))
        raise LoadError(f"{path}: {unfinished[0].__name__} lacks {lacking}")
    if not found:
        raise LoadError(
            f"{path}: it holds no effect, expected a class derived from Effect, an instance of one,"
            " or a call of sim2real.register"
        )
    for effect in found.values():
        name = getattr(effect, "id", "")
        if not name:
            raise LoadError(f"{path}: {type(effect).__name__} has no id")
        if name in CATALOGUE:
            raise LoadError(f"{path}: there is an effect {name!r} in the catalogue already")
    return tuple(found.values())


@contextmanager
def tried(effects: Sequence[Effect]) -> Iterator[None]:
    """Effects in the catalogue for a while."""
    before = dict(CATALOGUE)
    CATALOGUE.update({effect.id: effect for effect in effects})
    try:
        yield
    finally:
        CATALOGUE.clear()
        CATALOGUE.update(before)


def _loaded(path: Path) -> ModuleType:
    name = f"pdoik_checked_{path.stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise LoadError(f"{path}: Python cannot load it")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses look their own module up
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        lines = [
            each for each in traceback.extract_tb(error.__traceback__) if each.filename == str(path)
        ]
        where = f", line {lines[-1].lineno}" if lines else ""
        raise LoadError(
            f"{path}: it does not load{where}: {type(error).__name__}: {error}"
        ) from error
    finally:
        del sys.modules[name]
    return module


def _is_own_class(each: object, module: ModuleType) -> bool:
    return (
        isinstance(each, type)
        and issubclass(each, Effect)
        and each.__module__ == module.__name__
        and hasattr(each, "id")
        and not inspect.isabstract(each)
    )


def _is_unfinished(each: object, module: ModuleType) -> bool:
    return (
        isinstance(each, type)
        and inspect.isabstract(each)
        and issubclass(each, Effect)
        and each.__module__ == module.__name__
        and hasattr(each, "id")
    )


def _made(path: Path, kind: type[Effect]) -> Effect:
    try:
        return kind()
    except Exception as error:
        raise LoadError(f"{path}: {kind.__name__}() fails: {error}") from error
