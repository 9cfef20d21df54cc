"""Meshes whose files name a unit come out in metres, as Gazebo and RViz take them."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

import pdoik
from pdoik._meshes import read_triangles
from pdoik.occupancy_fit import load_geometry


@pytest.mark.parametrize(("unit", "scale"), [("0.0254", 0.0254), ("0.001", 0.001), ("1", 1.0)])
def test_a_collada_file_in_other_units_is_in_metres(
    tmp_path: Path, unit: str, scale: float
) -> None:
    box = trimesh.creation.box((10, 20, 30))
    path = tmp_path / "box.dae"
    box.export(path)
    text = path.read_text()
    assert text.count("<unit ") == 0 or 'meter="1' in text
    asset = f'<unit name="it" meter="{unit}"/><up_axis>Z_UP</up_axis></asset>'
    before = text.partition("<asset>")[0] + "<asset><created>2020-01-01T00:00:00Z</created>"
    before += "<modified>2020-01-01T00:00:00Z</modified>" + asset
    path.write_text(before + text.partition("</asset>")[2])
    vertices, faces = read_triangles(path)
    np.testing.assert_allclose(np.ptp(vertices, axis=0), scale * np.array([10, 20, 30]))
    assert len(faces) == 12
    urdf = (
        '<robot name="r"><link name="base"><collision><geometry>'
        f'<mesh filename="{path}" scale="2 1 1"/></geometry></collision></link></robot>'
    )
    (link,) = load_geometry(urdf)
    size = np.ptp(link.triangles.reshape(-1, 3), axis=0)
    np.testing.assert_allclose(size, scale * np.array([20, 20, 30]))


def test_a_scene_gives_a_mesh_without_units_its_scale(tmp_path: Path) -> None:
    trimesh.creation.box((300, 200, 100)).export(tmp_path / "part.stl")
    path = tmp_path / "scene.yaml"
    for scale, size in (("0.001", (0.3, 0.2, 0.1)), ("[0.001, 0.002, 0.003]", (0.3, 0.4, 0.3))):
        path.write_text(f"shapes: [{{name: part, mesh: {{file: part.stl, scale: {scale}}}}}]")
        (part,) = pdoik.load_scene(path).shapes
        np.testing.assert_allclose(np.ptp(part.vertices, axis=0), size)
    path.write_text("shapes: [{name: part, mesh: {file: part.stl}}]")
    with pytest.warns(pdoik.ObstacleWarning, match=r"is it in millimetres"):
        pdoik.load_scene(path)
    for scale, says in (
        ("0", r"\(part\).mesh.scale: expected numbers above 0"),
        ("[1, 2]", "3 numbers"),
    ):
        path.write_text(f"shapes: [{{name: part, mesh: {{file: part.stl, scale: {scale}}}}}]")
        with pytest.raises(pdoik.LoadError, match=says):
            pdoik.load_scene(path)


def test_an_empty_scene_is_told(tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text("shapes: []")
    with pytest.warns(pdoik.ObstacleWarning, match=r"scene.yaml: holds no obstacles"):
        assert pdoik.load_scene(path).shapes == []
