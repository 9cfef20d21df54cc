"""Convex pieces of links: what they hold, how far they stand out, and solves by them."""

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

import pdoik
from pdoik.occupancy_fit import fit_occupancy, fit_pieces

URDF = """<robot name="stick">
  <link name="base"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/>
    <origin xyz="0 0 0.2"/><axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="1"/>
  </joint>
  <link name="arm">
    <collision><origin xyz="0.2 0 0"/><geometry><box size="0.4 0.04 0.1"/></geometry></collision>
    <collision><origin xyz="0.4 0 0.1"/><geometry><box size="0.04 0.2 0.04"/></geometry></collision>
  </link>
</robot>"""


def _box(size: tuple[float, float, float], at: tuple[float, float, float]) -> trimesh.Trimesh:
    return trimesh.creation.box(
        extents=size, transform=trimesh.transformations.translation_matrix(at)
    )


def test_each_connected_convex_part_is_a_piece_that_holds_it() -> None:
    meshes = [
        trimesh.creation.cylinder(radius=0.05, height=0.2, sections=40),
        trimesh.creation.icosphere(radius=0.06),
        _box((0.1, 0.2, 0.05), (0.2, 0.0, 0.1)),
    ]
    triangles = np.concatenate([mesh.triangles for mesh in meshes])
    pieces = fit_pieces("link", triangles)
    assert len(pieces) == len(meshes)
    hulls = [ConvexHull(piece.vertices) for piece in pieces]
    for mesh in meshes:
        held = [
            (hull.equations[:, :3] @ mesh.vertices.T + hull.equations[:, 3:]).max() < -0.9e-5
            for hull in hulls
        ]
        assert any(held)
    for piece, hull in zip(pieces, hulls, strict=True):
        own = trimesh.Trimesh(piece.vertices, piece.triangles)
        assert own.is_watertight
        assert own.volume == pytest.approx(hull.volume, rel=1e-6)
        assert 1e-5 <= piece.tolerance < 1e-3


def test_a_link_that_is_not_made_of_convex_parts_has_none() -> None:
    ring = trimesh.creation.torus(0.1, 0.03)
    assert fit_pieces("link", np.asarray(ring.triangles)) == []
    assert fit_pieces("link", np.asarray(ring.triangles)[:40]) == []
    flat = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    assert fit_pieces("link", flat) == []


def test_a_fit_keeps_them_and_solves_are_as_exact_as_the_boxes_they_are(tmp_path) -> None:
    fit = fit_occupancy(URDF)
    assert [(row.link, row.n_pieces) for row in fit.report.links] == [("base", 1), ("arm", 2)]
    file = tmp_path / "stick.yaml"
    fit.write(file)
    occupancy = pdoik.Occupancy.load(file)
    assert [piece[0] for piece in occupancy.pieces] == ["base", "arm", "arm"]
    assert pdoik.Occupancy.load(occupancy.to_yaml()) == occupancy
    robot = pdoik.Robot.from_urdf(URDF)
    robot.occupancy = occupancy
    wide = pdoik.Solver(robot, pdoik.Options(exact_contact=False))
    exact = pdoik.Solver(robot)
    rng = np.random.default_rng(0)
    freed = touching = 0
    for _ in range(2000):
        q = rng.uniform(-1, 1, 1)
        at = robot.fk(q, "arm")
        point = (
            at[:3, :3] @ (rng.uniform(-1, 1, 3) * [0.3, 0.15, 0.2] + [0.25, 0, 0.05]) + at[:3, 3]
        )
        local = np.linalg.inv(at) @ [*point, 1]
        truly = min(
            _to_box(local[:3] - [0.2, 0, 0], np.array([0.2, 0.02, 0.05])),
            _to_box(local[:3] - [0.4, 0, 0.1], np.array([0.02, 0.1, 0.02])),
            _to_box(point, np.full(3, 0.05)),
        )
        said = exact.judge(at, q, point[None]).clearance
        assert said < 0 or truly >= 0
        assert said >= 0 or truly < max(row[3] for row in occupancy.pieces)
        assert truly < 0 or said <= truly
        touching += truly < 0
        freed += truly >= 0 and wide.judge(at, q, point[None]).clearance < 0
    assert touching > 20
    assert freed > 5


def _to_box(point: np.ndarray, half: np.ndarray) -> float:
    over = np.abs(point) - half
    return float(np.linalg.norm(np.maximum(over, 0)) + min(over.max(), 0))
