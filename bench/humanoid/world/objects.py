"""The flying object: a cloud for the solver, convex pieces for contact, a mesh to look at."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
import trimesh

import pdoik
from bench.common.arrays import FloatArray
from pdoik.clouds import load_cloud

OBJECT_NAMES = ("002_master_chef_can", "048_hammer", "011_banana")
OBJECT_BODY = "flying_object"
LEAF = 0.02  # [m]: the can's scan comes to the paper's 168 points
_COLORS = {
    "002_master_chef_can": (0.12, 0.30, 0.62, 1.0),
    "048_hammer": (0.80, 0.25, 0.10, 1.0),
    "011_banana": (0.95, 0.80, 0.15, 1.0),
}
_STAND_INS: dict[str, tuple[tuple[FloatArray, FloatArray, float], ...]] = {
    # cylinders: both ends and the radius [m], about as large as the scans
    "002_master_chef_can": ((np.array([0, 0, -0.07]), np.array([0, 0, 0.07]), 0.051),),
    "048_hammer": (
        (np.array([0, -0.165, 0]), np.array([0, 0.13, 0]), 0.016),
        (np.array([-0.09, 0.145, 0]), np.array([0.09, 0.145, 0]), 0.016),
    ),
    "011_banana": (
        (np.array([-0.035, -0.08, 0]), np.array([0.015, -0.02, 0]), 0.018),
        (np.array([0.015, -0.02, 0]), np.array([0.015, 0.03, 0]), 0.018),
        (np.array([0.015, 0.03, 0]), np.array([-0.03, 0.08, 0]), 0.016),
    ),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class FlyingObject:
    """A rigid object in a frame about the middle of its bounding box."""

    name: str
    cloud: FloatArray  # (K, 3): PCL's grid at LEAF on the surface, [m]
    surface: FloatArray  # (N, 3): the dense points behind it, [m]
    pieces: tuple[trimesh.Trimesh, ...]  # convex, for contact
    mesh: trimesh.Trimesh | None  # to look at; None: the pieces

    @property
    def radius(self) -> float:
        """Radius of the ball about the frame's origin that holds the object [m]."""
        reach = [np.linalg.norm(points, axis=1).max() for points in self._all_points()]
        return float(max(reach))

    def _all_points(self) -> list[FloatArray]:
        return [self.surface, *(np.asarray(piece.vertices) for piece in self.pieces)]


def ycb_folder(folder: str | Path | None = None) -> Path | None:
    """Where the YCB objects are: as given, else $PDOIK_SHARED/ycb; None without such a folder."""
    shared = os.environ.get("PDOIK_SHARED")
    path = Path(folder) if folder is not None else Path(shared) / "ycb" if shared else None
    return path if path is not None and path.is_dir() else None


def load_object(name: str, ycb: str | Path | None = None) -> FlyingObject:
    """One of OBJECT_NAMES.

    Args:
        name: As YCB has it.
        ycb: A folder with cloud_vertices/NAME.pcd, convex/NAME_*.stl and mesh/NAME.stl. None:
            cylinders of about the same size.

    Raises:
        ValueError: An unknown name.
        pdoik.LoadError: The folder lacks the object's files.
    """
    if name not in OBJECT_NAMES:
        raise ValueError(f"name is {name!r}, expected one of {OBJECT_NAMES}")
    if ycb is None:
        return _stand_in(name)
    folder = Path(ycb)
    vertices = load_cloud(folder / "cloud_vertices" / f"{name}.pcd")
    center = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    files = sorted((folder / "convex").glob(f"{name}_*.stl"))
    if not files:
        raise pdoik.LoadError(f"{folder}/convex: expected {name}_*.stl, got none")
    pieces = [_load_mesh(file, center) for file in files]
    return FlyingObject(
        name=name,
        cloud=pdoik.voxel_downsample(vertices, LEAF) - center,  # the grid of the scan's own frame
        surface=vertices - center,
        pieces=tuple(pieces),
        mesh=_load_mesh(folder / "mesh" / f"{name}.stl", center),
    )


def _load_mesh(file: Path, center: FloatArray) -> trimesh.Trimesh:
    try:
        mesh = trimesh.load_mesh(file)
    except Exception as error:  # trimesh's loaders raise whatever their parsers do
        raise pdoik.LoadError(f"cannot read mesh {file}: {error}") from error
    mesh.apply_translation(-center)
    return mesh


def _stand_in(name: str) -> FlyingObject:
    pieces = tuple(
        trimesh.creation.cylinder(radius=radius, segment=np.array([a, b]), sections=48)
        for a, b, radius in _STAND_INS[name]
    )
    surface = np.concatenate([trimesh.sample.sample_surface(p, 4000, seed=0)[0] for p in pieces])
    return FlyingObject(
        name=name,
        cloud=pdoik.voxel_downsample(surface, LEAF),
        surface=np.asarray(surface),
        pieces=pieces,
        mesh=None,
    )


def add_object(spec: mujoco.MjSpec, thing: FlyingObject, contype: int) -> None:
    """Put the object in the world as a mocap body: it goes where it is sent, whatever it meets."""
    body = spec.worldbody.add_body(name=OBJECT_BODY, mocap=True)
    color = _COLORS[thing.name]
    for k, piece in enumerate(thing.pieces):
        _add_mesh(spec, f"object_piece_{k}", piece)
        body.add_geom(
            name=f"object_{k}",
            type=mujoco.mjtGeom.mjGEOM_MESH,
            meshname=f"object_piece_{k}",
            contype=contype,
            conaffinity=0,
            rgba=color,
            group=1 if thing.mesh is None else 3,
        )
    if thing.mesh is not None:
        _add_mesh(spec, "object_mesh", thing.mesh)
        body.add_geom(
            name="object_look",
            type=mujoco.mjtGeom.mjGEOM_MESH,
            meshname="object_mesh",
            contype=0,
            conaffinity=0,
            rgba=color,
            group=1,
        )


def _add_mesh(spec: mujoco.MjSpec, name: str, mesh: trimesh.Trimesh) -> None:
    added = spec.add_mesh(name=name)
    added.uservert = np.asarray(mesh.vertices, dtype=np.float64).ravel()
    added.userface = np.asarray(mesh.faces, dtype=np.int32).ravel()
    added.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX  # open meshes have none else
