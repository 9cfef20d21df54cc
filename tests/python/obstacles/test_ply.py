"""PLY files: faces of any number of corners, in text and in both orders of bytes."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
import trimesh

import pdoik
from pdoik._meshes import read_triangles
from pdoik._ply import PlyError, read_ply
from pdoik._polygons import triangulated
from pdoik.clouds import load_cloud
from polygon_files import CUBE, FORMATS, QUADS, ply_bytes, prism

RNG = np.random.default_rng(5)


def mesh_of(content: bytes) -> trimesh.Trimesh:
    ply = read_ply(content)
    faces = triangulated(ply.vertices, ply.corners, ply.counts)
    return trimesh.Trimesh(ply.vertices, faces, process=False)


def star(corners: int, rng: np.random.Generator) -> np.ndarray:
    """A polygon that does not cross itself and is anything but convex."""
    angles = 2 * np.pi * (np.arange(corners) + rng.uniform(-0.3, 0.3, corners)) / corners
    radii = rng.uniform(0.2, 1.0, corners)
    return np.c_[radii * np.cos(angles), radii * np.sin(angles)]


def area(outline: np.ndarray) -> float:
    x, y = outline.T
    return float(0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


@pytest.mark.parametrize("encoding", ["ascii", "binary"])
def test_triangles_come_out_as_trimesh_reads_them(encoding: str) -> None:
    mesh = trimesh.creation.icosphere(subdivisions=3)
    mesh.visual.vertex_colors = RNG.integers(0, 255, (len(mesh.vertices), 4))
    content = mesh.export(file_type="ply", encoding=encoding)
    theirs = trimesh.load_mesh(io.BytesIO(content), file_type="ply", process=False)
    ours = mesh_of(content)
    np.testing.assert_allclose(ours.vertices, theirs.vertices, atol=1e-7)  # single precision
    np.testing.assert_array_equal(ours.faces, theirs.faces)


@pytest.mark.parametrize("layout", FORMATS)
@pytest.mark.parametrize("colors", [False, True])
def test_a_cube_of_six_quads_is_a_closed_cube(layout: str, colors: bool) -> None:
    mesh = mesh_of(ply_bytes(CUBE, QUADS, layout, colors))
    assert len(mesh.faces) == 12
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(1.0)  # positive: they turn as the quads do
    assert mesh.area == pytest.approx(6.0)


@pytest.mark.parametrize("layout", FORMATS)
def test_faces_of_three_to_many_corners_are_read_from_one_file(layout: str) -> None:
    outline = star(17, RNG)
    vertices, faces = prism(outline, 0.5)
    faces[2:4] = [[*quad[:3]] for quad in faces[2:4]] + [[q[0], q[2], q[3]] for q in faces[2:4]]
    mesh = mesh_of(ply_bytes(vertices, faces, layout))
    assert len(mesh.faces) == 2 * 15 + 2 * 17
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(0.5 * area(outline), rel=1e-12)


@pytest.mark.parametrize("corners", [4, 5, 8, 30])
def test_concave_polygons_keep_their_area_whichever_way_they_lie(corners: int) -> None:
    for _ in range(40):
        outline = star(corners, RNG)
        vertices, faces = prism(outline, 1.0)
        R = trimesh.transformations.random_rotation_matrix(RNG.random(3))[:3, :3]
        turned = vertices @ R.T + RNG.uniform(-5, 5, 3)
        shift = int(RNG.integers(corners))  # the first corner may be the concave one
        faces[1] = faces[1][shift:] + faces[1][:shift]
        mesh = mesh_of(ply_bytes(turned, faces, "binary_little_endian"))
        top = mesh.triangles_cross[(mesh.faces >= corners).all(axis=1)] / 2
        np.testing.assert_allclose(top.sum(axis=0), area(outline) * R[:, 2], atol=1e-9)
        assert np.linalg.norm(top, axis=1).sum() == pytest.approx(area(outline))  # none overlaps
        assert mesh.is_watertight
        assert mesh.volume == pytest.approx(area(outline))


def test_corners_in_line_with_their_neighbours_keep_a_solid_closed() -> None:
    ell = np.array([[0, 0], [1, 0], [2, 0], [2, 1], [1.5, 1], [1, 1], [1, 2], [0, 2], [0, 1.0]])
    mesh = mesh_of(ply_bytes(*prism(ell, 1.0), "ascii"))
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(3.0)


def test_obstacles_meshes_and_clouds_are_read_from_polygons(tmp_path: Path) -> None:
    path = tmp_path / "cube.ply"
    path.write_bytes(ply_bytes(CUBE, QUADS, "binary_big_endian"))
    (tmp_path / "scene.yaml").write_text("shapes: [{name: cube, mesh: {file: cube.ply}}]")
    (shape,) = pdoik.load_scene(tmp_path / "scene.yaml").shapes
    assert trimesh.Trimesh(shape.vertices, shape.triangles).volume == pytest.approx(1.0)
    np.testing.assert_array_equal(load_cloud(path), CUBE)
    vertices, faces = read_triangles(path)
    assert (vertices.shape, faces.shape) == ((8, 3), (12, 3))


def test_a_face_of_two_corners_is_nothing_and_one_without_area_stays_finite() -> None:
    line = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0.0]])
    ply = read_ply(ply_bytes(line, [[0, 1], [0, 1, 2, 3]], "ascii"))
    triangles = triangulated(ply.vertices, ply.corners, ply.counts)
    assert triangles.shape == (2, 3)
    assert set(triangles.ravel()) == {0, 1, 2, 3}


@pytest.mark.parametrize("layout", FORMATS)
@pytest.mark.parametrize("cut", [0.3, 0.7, 0.97])
def test_a_file_cut_short_is_refused(layout: str, cut: float) -> None:
    mixed = [*QUADS[:3], [0, 2, 6], [0, 6, 4]]
    content = ply_bytes(CUBE, mixed, layout)
    with pytest.raises(PlyError, match=r"cut short|no PLY header"):
        read_ply(content[: int(cut * len(content))])


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        (b"ply\n", b"solid\n", "has no PLY header"),
        (b"format ascii", b"format morse", "the header has a line 'format morse"),
        (b"element face 6", b"element face 600000000", "promises 600000000 of face"),
        (b"element vertex 8", b"element vertex -8", "the header has a line"),
        (b"property double z", b"property double w", "expected vertices with x, y, z"),
        (b"4 0 1 3 2", b"4 0 1 3 8", "a corner that is none of the 8 vertices"),
        (b"4 0 1 3 2", b"4 0 1 3 -1", "a corner that is none of the 8 vertices"),
        (b"4 0 1 3 2", b"4 0 1 3 two", "expected numbers"),
        (b"4 0 1 3 2", b"-4 0 1 3 2", "cut short"),
        (b"list uchar int", b"list float int", "the header has a line"),
        (b"end_header\n", b"", "the header has a line"),
    ],
)
def test_what_is_wrong_is_told(old: bytes, new: bytes, says: str) -> None:
    content = ply_bytes(CUBE, QUADS, "ascii")
    assert old in content
    with pytest.raises(PlyError, match=says):
        read_ply(content.replace(old, new, 1))


def test_points_alone_are_no_mesh(tmp_path: Path) -> None:
    path = tmp_path / "points.ply"
    path.write_bytes(ply_bytes(CUBE, [], "ascii"))
    with pytest.raises(pdoik.LoadError, match=r"points.ply: it holds no faces; .* as a cloud"):
        read_triangles(path)
