"""Gazebo's worlds and models with what they include, from files that they name."""

from __future__ import annotations

import re
from copy import deepcopy
from pathlib import Path
from xml.etree.ElementTree import Element

from pdoik._addresses import Packages, Places, is_folder
from pdoik.errors import LoadError
from pdoik.scenes.sdf.frames import Scope
from pdoik.scenes.values import EntryError
from pdoik.scenes.xml import root_of, text_of

_DEEPEST = 30  # includes within includes
_VERSION = re.compile(r"\d+(?:\.\d+)*")


def scope_of(
    element: Element, file: Path, packages: Packages, name: str = "", depth: int = 0
) -> Scope:
    """A world or model, and the models in it and in what they include.

    Raises:
        EntryError: What is included is nowhere, no model, or includes itself.
    """
    if depth > _DEEPEST:
        raise EntryError(file, f"includes stand {_DEEPEST} deep: one includes itself", name)
    scope = Scope(deepcopy(element), file, name)
    for k, child in enumerate(list(scope.element)):
        if child.tag not in ("model", "include"):
            continue
        model, where = child, file
        if child.tag == "include":
            model, where = _included(child, file, packages)
            scope.element[k] = model
        called = str(model.get("name", ""))
        if not called:
            raise EntryError(file, "a model has no name", name)
        if called in scope.models:
            raise EntryError(file, f"two models are named {called!r}", name)
        within = f"{name}::{called}" if name else called
        scope.models[called] = scope_of(model, where, packages, within, depth + 1)
    return scope


def _included(include: Element, file: Path, packages: Packages) -> tuple[Element, Path]:
    """The model that an <include> names, as it changes it, and the file that has it."""
    uri = text_of(include, "uri")
    entry = f"include {uri}"
    path = _model_file(uri, file, packages, entry)
    root = root_of(path)
    models = root.findall("model")
    if root.tag not in ("sdf", "gazebo") or len(models) != 1:
        raise EntryError(file, f"{path} is to hold <sdf> with one <model>", entry)
    model = deepcopy(models[0])
    if name := text_of(include, "name"):
        model.set("name", name)
    if placed := text_of(include, "placement_frame"):
        model.set("placement_frame", placed)
    for tag in ("pose", "static"):
        changed = include.find(tag)
        if changed is not None:
            for old in model.findall(tag):
                model.remove(old)
            model.append(changed)
    return model, path


def _model_file(uri: str, file: Path, packages: Packages, entry: str) -> Path:
    """The file of an address: itself, or the newest that the folder's model.config names."""
    if not uri:
        raise EntryError(file, "an <include> has no <uri>")
    if uri.startswith(("http://", "https://")):
        what = "is not fetched: download the model, and give the folder above it, packages=[...]"
        raise EntryError(file, what, entry)
    here = Places.of(packages, file)
    for name in ("model.config", "manifest.xml"):
        try:
            config = here.find(f"{uri.rstrip('/')}/{name}")
        except LoadError:
            continue
        said = [
            (_version(each), (each.text or "").strip()) for each in root_of(config).findall("sdf")
        ]
        if said:
            return config.parent / max(said)[1]
    try:
        return here.find(uri)
    except LoadError as error:
        plain = file.parent / uri
        if is_folder(plain):
            raise EntryError(file, f"{plain} has no model.config", entry) from error
        raise EntryError(file, f"model {error}", entry) from error


def _version(element: Element) -> tuple[int, ...]:
    found = _VERSION.match(element.get("version", ""))
    return tuple(map(int, found[0].split("."))) if found else ()
