"""Solid shapes of the problem sets: their samples lie on them and leave no gap."""

from __future__ import annotations

import numpy as np
import pytest

coal = pytest.importorskip("coal")
pytest.importorskip("pinocchio")

import trimesh  # noqa: E402
from scipy.spatial import cKDTree  # noqa: E402
from scipy.spatial.transform import Rotation  # noqa: E402

from bench.ik.problems.solids import Solid, SolidError, mesh, pose  # noqa: E402

PLACE = pose((0.3, -0.2, 0.5), Rotation.from_euler("xyz", (0.4, -0.7, 1.1)).as_matrix())
SIZES = {
    "box": (0.3, 0.2, 0.04),
    "sphere": (0.1,),
    "cylinder": (0.03, 0.14),
    "capsule": (0.05, 0.2),
    "half_space": (),
}
LEAF = 0.01


def solid(kind: str) -> Solid:
    if kind == "mesh":
        return mesh("thing", trimesh.creation.cone(0.1, 0.2, sections=16), PLACE)
    return Solid("thing", kind, SIZES[kind], PLACE)


def distance_to(thing: Solid, point: np.ndarray) -> float:
    probe, place = coal.Sphere(1e-7), coal.Transform3s(thing.T[:3, :3], thing.T[:3, 3])
    at, result = coal.Transform3s(np.eye(3), point), coal.DistanceResult()
    request = coal.DistanceRequest()
    return coal.distance(probe, at, thing.geometry(), place, request, result)


@pytest.mark.parametrize("kind", SIZES)
def test_samples_lie_on_the_surface_by_coal(kind: str) -> None:
    thing = solid(kind)
    middle = (PLACE @ [0, 0, -1 if kind == "half_space" else 0, 1])[:3]
    points = thing.sample(LEAF)
    for point in points[:: max(1, len(points) // 300)]:
        outward = 1e-4 * (point - middle)
        assert distance_to(thing, point - outward) <= 0
        assert 0 < distance_to(thing, point + outward) <= np.linalg.norm(outward) + 1e-6


def test_samples_of_a_mesh_lie_on_its_triangles() -> None:
    surface, points = solid("mesh").surface(), solid("mesh").sample(LEAF)
    toward = points[:, None] - surface.triangles[None, :, 0]
    outside = np.einsum("pfi,fi->pf", toward, surface.face_normals).max(axis=1)
    assert np.abs(outside).max() < 1e-9  # a convex surface: on one face, behind all others


@pytest.mark.parametrize("kind", ["box", "sphere", "cylinder", "capsule", "mesh"])
def test_no_point_of_the_surface_is_far_from_a_sample(kind: str) -> None:
    thing = solid(kind)
    points, _ = trimesh.sample.sample_surface(thing.surface(), 3000, seed=0)
    facets = 0.002  # how far a facet of the picture is from a round surface
    far, _ = cKDTree(thing.sample(LEAF)).query(points)
    assert far.max() <= LEAF / np.sqrt(2) + facets


def test_a_moved_solid_is_sampled_where_it_went() -> None:
    thing = solid("capsule")
    T = pose((1, 2, 3), Rotation.from_euler("z", 0.5).as_matrix())
    np.testing.assert_allclose(
        thing.moved(T).sample(LEAF), thing.sample(LEAF) @ T[:3, :3].T + T[:3, 3], atol=1e-12
    )


@pytest.mark.parametrize(
    ("kind", "size", "T", "said"),
    [
        ("ring", (1.0,), np.eye(4), "kind is 'ring'"),
        ("box", (1.0, 1.0), np.eye(4), "a box has 3 sizes"),
        ("sphere", (0.0,), np.eye(4), "must be positive"),
        ("sphere", (1.0,), 2 * np.eye(4), "not a rigid"),
        ("mesh", (), np.eye(4), "without triangles"),
    ],
)
def test_a_solid_that_cannot_be_says_why(kind: str, size: tuple, T: np.ndarray, said: str) -> None:
    with pytest.raises(SolidError, match=f"odd: .*{said}"):
        Solid("odd", kind, size, T)
