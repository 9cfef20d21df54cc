"""Scenes: the same for the same seed, of everyday size, inside the paper's ranges."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from pypcd4 import PointCloud

from bench.ik.scenes import objects as scenes
from bench.ik.scenes import primitives


@pytest.fixture(scope="module")
def models() -> tuple:
    return scenes.primitive_models()


def test_a_seed_gives_one_scene(models: tuple) -> None:
    first, again, other = (
        scenes.random_scene(np.random.default_rng(seed), models, 5) for seed in (7, 7, 8)
    )
    np.testing.assert_array_equal(first.points, again.points)
    assert [placed.model.name for placed in first.objects] == [
        placed.model.name for placed in again.objects
    ]
    assert not np.array_equal(first.points, other.points)


def test_models_do_not_depend_on_anything_but_their_seed(models: tuple) -> None:
    for model, again in zip(models, scenes.primitive_models(), strict=True):
        np.testing.assert_array_equal(model.points, again.points)


def test_objects_are_of_everyday_size(models: tuple) -> None:
    assert len(models) >= 12
    assert len({model.name for model in models}) == len(models)
    for model in models:
        assert 0.03 < model.size.max() < 0.35, model.name
        assert model.size.min() > 0.01, model.name
        np.testing.assert_allclose(model.points.max(axis=0), -model.points.min(axis=0), atol=1e-12)


def test_poses_and_scales_fill_the_papers_ranges(models: tuple) -> None:
    rng = np.random.default_rng(0)
    placed = [scenes.random_object(rng, models) for _ in range(600)]
    centers = np.array([each.T_base_object[:3, 3] for each in placed])
    scales = np.array([each.scale for each in placed])
    assert (centers >= scenes.CENTER_LOWER).all()
    assert (centers <= scenes.CENTER_UPPER).all()
    np.testing.assert_allclose(centers.mean(axis=0), [0, 0, 0.6], atol=0.07)
    assert scales.min() >= 1
    assert scales.max() <= 3
    assert abs(scales.mean() - 2) < 0.1
    assert {each.model.name for each in placed} == {model.name for model in models}


def test_an_objects_points_are_centred_scaled_and_rigidly_moved(models: tuple) -> None:
    placed = scenes.random_object(np.random.default_rng(5), models)
    local = (placed.points - placed.T_base_object[:3, 3]) @ placed.T_base_object[:3, :3]
    np.testing.assert_allclose(local, placed.scale * placed.model.points, atol=1e-12)


def test_rotations_are_rotations_in_every_direction() -> None:
    rng = np.random.default_rng(1)
    rotations = np.array([scenes.random_rotation(rng) for _ in range(2000)])
    products = rotations @ rotations.transpose(0, 2, 1)
    np.testing.assert_allclose(products, np.broadcast_to(np.eye(3), products.shape), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(rotations), 1)
    np.testing.assert_allclose(rotations.mean(axis=0), 0, atol=0.06)


def test_a_scene_keeps_to_what_is_clear(models: tuple) -> None:
    def is_clear(scene: object) -> bool:
        return bool((np.linalg.norm(scene.points - [0, 0, 0.5], axis=1) > 0.3).all())

    scene = scenes.random_scene(np.random.default_rng(2), models, 9, is_clear)
    assert len(scene.objects) == 9
    assert is_clear(scene)


def test_a_scene_that_cannot_be_clear_is_given_up(models: tuple) -> None:
    with pytest.raises(scenes.SceneError, match="object 1 of 3: 20 draws"):
        scenes.random_scene(np.random.default_rng(2), models, 3, lambda scene: False, max_draws=20)


def test_a_cloud_has_one_point_per_cell(models: tuple) -> None:
    scene = scenes.random_scene(np.random.default_rng(4), models, 6)
    cells = np.unique(np.floor(scene.points / 0.1), axis=0)
    assert abs(len(scene.cloud(0.1)) - len(cells)) <= 2  # float32 near the walls
    assert scenes.Scene(objects=()).cloud(0.1).shape == (0, 3)


@pytest.mark.parametrize("radius", [(0.02, 0.1), (0.1, 0.02), (0.0, 0.1), (0.05, 0.05)])
def test_a_cone_is_sampled_uniformly(radius: tuple[float, float]) -> None:
    cone = primitives.Frustum(z=(0.1, 0.4), radius=radius)
    points = cone.sample(20000, np.random.default_rng(6))
    t = (points[:, 2] - 0.1) / 0.3
    np.testing.assert_allclose(
        np.hypot(points[:, 0], points[:, 1]), radius[0] + t * (radius[1] - radius[0]), atol=1e-12
    )
    halfway = primitives.Frustum(z=(0.1, 0.25), radius=(radius[0], sum(radius) / 2))
    assert abs((t < 0.5).mean() - halfway.area / cone.area) < 0.015
    np.testing.assert_allclose(points[:, :2].mean(axis=0), 0, atol=0.002)


def test_a_boxs_faces_hold_points_by_their_area() -> None:
    points = primitives.sample_surface(
        primitives.box(0.1, 0.2, 0.3), 22000, np.random.default_rng(6)
    )
    on_face = np.isclose(np.abs(points), [0.05, 0.1, 0.15], rtol=0, atol=1e-12)
    np.testing.assert_array_equal(on_face.sum(axis=1), 1)
    np.testing.assert_allclose(on_face.sum(axis=0) / 22000, np.array([6, 3, 2]) / 11, atol=0.015)
    assert (np.abs(points) <= np.array([0.05, 0.1, 0.15]) + 1e-12).all()


def test_a_ball_is_sampled_uniformly() -> None:
    points = primitives.Ball(radius=0.2).sample(20000, np.random.default_rng(6))
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 0.2)
    assert abs((points[:, 2] > 0.1).mean() - 0.25) < 0.015  # Archimedes


def test_scans_are_read_from_a_folder(tmp_path: Path, models: tuple) -> None:
    (tmp_path / "cloud_vertices").mkdir()
    for model in models[:3]:
        file = tmp_path / "cloud_vertices" / f"{model.name}.pcd"
        PointCloud.from_xyz_points((model.points + 0.5).astype(np.float32)).save(file)
    scans = scenes.ycb_models(tmp_path)
    assert [scan.name for scan in scans] == sorted(model.name for model in models[:3])
    by_name = {model.name: model for model in models}
    for scan in scans:
        np.testing.assert_allclose(scan.points, by_name[scan.name].points, atol=1e-6)


def test_a_folder_without_scans_is_refused(tmp_path: Path) -> None:
    with pytest.raises(scenes.SceneError, match="cloud_vertices"):
        scenes.ycb_models(tmp_path)


def test_meshes_are_the_surfaces_that_the_points_are_on(models: tuple) -> None:
    for model in models:
        low, high = model.triangles.min(axis=(0, 1)), model.triangles.max(axis=(0, 1))
        np.testing.assert_allclose(high - low, model.size, rtol=0.03, atol=2e-3)
        mesh = trimesh.Trimesh(**trimesh.triangles.to_kwargs(model.triangles), process=False)
        _, distances, _ = trimesh.proximity.closest_point_naive(mesh, model.points[:50])
        assert distances.max() < 0.01 * model.size.max(), model.name
