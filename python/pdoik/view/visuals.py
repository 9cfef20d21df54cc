"""What a URDF's links look like, for a page: one GLB per link."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np
import numpy.typing as npt
import trimesh
from trimesh.visual.material import PBRMaterial

from pdoik._addresses import Packages, Places
from pdoik.descriptions import numbers, pose_of, tree_of
from pdoik.errors import LoadError

FloatArray = npt.NDArray[np.float64]

_GREY = (0.78, 0.80, 0.83, 1.0)


def load_visuals(urdf: Path, packages: Packages = ()) -> tuple[dict[str, bytes], list[str]]:
    """GLB files of the links that have geometry, and why others lack theirs.

    Of each link its <visual> elements are taken, or its <collision> elements where one of those
    cannot be had.

    Args:
        urdf: The description.
        packages: As in `pdoik.urdf_text`.

    Raises:
        LoadError: The URDF cannot be read.
    """
    root = tree_of(urdf)
    places = Places.of(packages, urdf)
    colors = {
        str(material.get("name")): _rgba(material)
        for material in root.findall("material")
        if material.find("color") is not None
    }
    visuals, missing = {}, []
    for link in root.findall("link"):
        name = str(link.get("name"))
        reason = ""
        for kind in ("visual", "collision"):
            elements = link.findall(kind)
            if not elements:
                continue
            try:
                visuals[name] = _glb(elements, colors, places)
                reason = ""
                break
            except Exception as error:  # mesh readers raise whatever their parsing stumbles over
                reason = reason or f"{name}: {error}"
        if reason:
            missing.append(reason)
    return visuals, missing


def _glb(
    elements: list[Element],
    colors: dict[str, tuple[float, ...]],
    places: Places,
) -> bytes:
    scene = trimesh.Scene()
    for element in elements:
        T_link_shape = pose_of(element)
        material = element.find("material")
        color = None
        if material is not None:
            color = _rgba(material) if material.find("color") is not None else None
            color = color or colors.get(str(material.get("name")))
        for mesh in _shape(element, places):
            if color is not None or not _has_color(mesh):
                mesh.visual = painted(color or _GREY)
            scene.add_geometry(mesh, transform=T_link_shape)
    return bytes(scene.export(file_type="glb"))  # type: ignore[no-untyped-call]


def painted(rgba: tuple[float, ...]) -> Any:
    """A mesh's `visual` of one colour."""
    material = PBRMaterial(  # type: ignore[no-untyped-call]
        baseColorFactor=rgba, metallicFactor=0.1, roughnessFactor=0.6
    )
    return trimesh.visual.TextureVisuals(material=material)  # type: ignore[no-untyped-call]


def _shape(element: Element, places: Places) -> list[trimesh.Trimesh]:
    shape = element.find("geometry/*")
    if shape is None:
        raise LoadError("an element without geometry")
    if shape.tag == "box":
        return [trimesh.creation.box(extents=numbers(shape, "size", 3, "box"))]
    if shape.tag == "cylinder":
        (radius,) = numbers(shape, "radius", 1, "cylinder")
        (length,) = numbers(shape, "length", 1, "cylinder")
        return [trimesh.creation.cylinder(radius=radius, height=length, sections=48)]
    if shape.tag == "sphere":
        (radius,) = numbers(shape, "radius", 1, "sphere")
        return [trimesh.creation.icosphere(subdivisions=3, radius=radius)]
    if shape.tag != "mesh":
        raise LoadError(f"unknown shape <{shape.tag}>")
    scale = np.diag([*numbers(shape, "scale", 3, "mesh", default="1 1 1"), 1.0])
    loaded = trimesh.load_scene(places.find(str(shape.get("filename"))))
    meshes = [mesh for mesh in loaded.dump() if isinstance(mesh, trimesh.Trimesh)]
    return [mesh.apply_transform(scale) for mesh in meshes]


def _has_color(mesh: trimesh.Trimesh) -> bool:
    return mesh.visual is not None and bool(mesh.visual.defined)


def _rgba(material: Element) -> tuple[float, ...]:
    color = material.find("color")
    words = "" if color is None else color.get("rgba", "")
    return tuple(float(word) for word in words.split()) or _GREY
